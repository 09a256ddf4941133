// Opens a replay page in headless Chromium and prints what it finds as one JSON object, for test/scripts/replay_browser.py.
//   node browse.mjs PAGE.html SCREENSHOT.png 'JSON of {times, links: [[body, link]], play: seconds, follow: body, numbers: bool, click: bool}'
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(`${process.env.NODE_PATH}/`);
const puppeteer = require("puppeteer-core");
const [page_file, screenshot, text] = process.argv.slice(2);
const wanted = JSON.parse(text);

const browser = await puppeteer.launch({
  executablePath: "/usr/bin/chromium", headless: true,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});
const page = await browser.newPage();
await page.setViewport({ width: 1400, height: 800 });
const result = { errors: [], requests: [], links: [], frames: [] };
page.on("console", (message) => ["error", "warning"].includes(message.type()) && result.errors.push(message.text()));
page.on("pageerror", (error) => result.errors.push(String(error)));
page.on("dialog", (dialog) => { result.errors.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
page.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && result.requests.push(request.url()));

const begin = Date.now();
await page.goto(pathToFileURL(page_file).href, { timeout: 300000 });
await page.waitForFunction(() => window.replay?.ready || document.querySelector(".failed"), { timeout: 300000 });
result.loading = (Date.now() - begin) / 1000;
result.failed = await page.$eval("#app", (app) => app.querySelector(".failed")?.textContent ?? "");
const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

// By the slider, as a hand would move it: the n-th frame of `times`.
for (const frame of wanted.frames ?? []) {
  await page.$eval("#time", (slider, value) => { slider.value = value; slider.dispatchEvent(new Event("input")); }, frame);
  await settle();
  result.frames.push(await page.evaluate(() => window.replay.frame));
  result.links.push(await page.evaluate((links) => links.map(([body, link]) => window.replay.linkMatrix(body, link)), wanted.links ?? []));
}
if (wanted.click) { // in the middle of the first plot
  const before = await page.evaluate(() => window.replay.time);
  const box = await (await page.$(".u-over")).boundingBox();
  await page.mouse.click(box.x + box.width * wanted.click, box.y + box.height / 2);
  await settle();
  result.clicked = [before, await page.evaluate(() => window.replay.time)];
}
if (wanted.follow !== undefined) await page.select("#follow", String(wanted.follow));
if (wanted.numbers) await page.evaluate(() => { window.replay.forces.numbers = true; window.replay.dirty = true; });
if (wanted.view) await page.evaluate((view) => {
  const { camera, controls } = window.replay;
  controls.target.set(...view.target);
  camera.position.set(...view.position);
  window.replay.dirty = true;
}, wanted.view);
if (wanted.play) {
  await page.evaluate(() => { window.replay.seek(window.replay.times[0]); window.replay.work = []; window.replay.play(true); });
  const intervals = await page.evaluate((seconds) => new Promise((done) => {
    const stamps = [];
    const end = performance.now() + 1000 * seconds;
    const tick = (now) => { stamps.push(now); now < end ? requestAnimationFrame(tick) : done(stamps.slice(1).map((stamp, i) => stamp - stamps[i])); };
    requestAnimationFrame(tick);
  }), wanted.play);
  const work = await page.evaluate(() => { window.replay.play(false); return window.replay.work; });
  const sorted = (list) => [...list].sort((a, b) => a - b);
  const at = (list, share) => sorted(list)[Math.floor(share * (list.length - 1))];
  result.play = { pictures: intervals.length, interval_median: at(intervals, 0.5), interval_95: at(intervals, 0.95), work_median: at(work, 0.5), work_95: at(work, 0.95) };
}
// What a picture costs the script, without drawing it: of 200 frames in a row, from the middle on [ms].
result.update = await page.evaluate(() => {
  const { replay } = window, first = Math.floor(replay.times.length / 2), begin = performance.now();
  let count = 0;
  for (let frame = first; frame < Math.min(first + 200, replay.times.length); ++frame, ++count) {
    replay.bodies.show(frame);
    replay.forces?.show(frame);
  }
  return (performance.now() - begin) / Math.max(count, 1);
});
if (wanted.select) { // the arrow of the largest force, as a click on it chooses it
  await page.evaluate(() => {
    const { contacts, frame } = window.replay;
    let largest = -1;
    contacts.at(frame, (run) => { if (largest < 0 || contacts.size[run] > contacts.size[largest]) largest = run; });
    window.replay.selected = largest < 0 ? -1 : contacts.key[largest];
    window.replay.showContact();
  });
}
await settle();
// A page that stands still is not drawn again.
const drawn = await page.evaluate(() => window.replay.renderer?.info.render.frame ?? 0);
await page.evaluate(() => new Promise((done) => setTimeout(done, 500)));
result.drawn_at_rest = (await page.evaluate(() => window.replay.renderer?.info.render.frame ?? 0)) - drawn;
result.contact = await page.$eval(".contact", (table) => (table.hidden ? "" : table.innerText));
result.bodies = await page.$$eval("#follow option", (options) => options.map((option) => option.textContent));
result.notes = await page.$$eval(".notes p", (notes) => notes.map((note) => note.textContent));
result.scripts = await page.$$eval("script", (scripts) => scripts.length);
result.injected = await page.evaluate(() => window.injected ?? null);
result.triangles = await page.evaluate(() => window.replay.renderer?.info.render.triangles ?? 0);
result.calls = await page.evaluate(() => window.replay.renderer?.info.render.calls ?? 0);
if (screenshot) await page.screenshot({ path: screenshot });
console.log(JSON.stringify(result));
await browser.close();
