// The replay page: reads the recording that src/tools/replay put into it, and shows it.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Bodies } from "./bodies.js";
import { Contacts } from "./contacts.js";
import { element, Panel } from "./panel.js";
import { Forces } from "./forces.js";
import { addPlots, Plots } from "./plots.js";
import { sidesInContact } from "./series.js";
import "./style.css";
import { lastNotAfter, Tracks } from "./tracks.js";
import { columns, floats } from "./unpack.js";

const LEGEND_INTERVAL = 100; // between two updates of what is written [ms]

class Replay {
  constructor(data) {
    this.data = data;
    this.notes = [...data.notes];
    this.frame = 0;
    this.time = 0;
    this.playing = false;
    this.speed = 1;
    this.followed = -1;
    this.selected = -1; // key of a contact
    this.work = []; // of the last pictures [ms]
  }

  async load() {
    const { data } = this;
    this.times = await floats(data.times);
    this.tracks = await Tracks.read(data.tracks);
    this.contacts = await Contacts.read(data.contacts, data.sides, data.frames);
    this.reportTimes = await floats(data.report_times);
    this.reports = {};
    for (const [name, packed] of Object.entries(data.reports))
      this.reports[name] = packed.kind === "int" ? (await columns(packed))[0] : await floats(packed);
    this.panel = new Panel(document.getElementById("app"), this);
    this.bodies = new Bodies(data, this.tracks, (note) => this.notes.push(note));
    await this.bodies.load();
    this.bodies.show(0);
    this.size = this.bodies.typicalSize() || data.size;
    this.plots = new Plots(this.panel.plots, (time) => this.seek(time));
    const { showForces, largest } = addPlots(this.plots, data, this.times, this.contacts, this.reportTimes, this.reports);
    this.panel.fill(this.bodies.things, sidesInContact(this.contacts), (side) => showForces(side < 0 ? largest : [side]));
    try {
      this.openView();
    } catch (error) {
      this.notes.push(`no picture: ${error.message} (WebGL is needed)`);
    }
    this.panel.showNotes(this.notes);
    this.seek(this.times[0] ?? 0);
    this.last = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  openView() {
    const { canvas, labels } = this.panel;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: false });
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color("#eef1f5");
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#9a9a90", 2.2));
    const sun = new THREE.DirectionalLight("#ffffff", 1.8);
    sun.position.set(0.6, -1.0, 1.6);
    this.scene.add(sun);
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => (this.redraw = true));
    this.forces = new Forces(this.contacts, this.size, labels);
    this.scene.add(this.bodies.group, this.forces.group);
    this.lookAtAll();
    this.addGround();
    canvas.addEventListener("click", (event) => this.pick(event));
  }

  lookAtAll() {
    const box = this.bodies.box(), point = new THREE.Vector3();
    if (box.isEmpty())
      for (let run = 0; run < Math.min(this.contacts.count, 1000); ++run)
        box.expandByPoint(point.set(...this.contacts.position.map((column) => column[run])));
    if (box.isEmpty()) box.setFromCenterAndSize(new THREE.Vector3(), new THREE.Vector3(1, 1, 1));
    const center = box.getCenter(new THREE.Vector3()), radius = Math.max(0.5 * box.getSize(new THREE.Vector3()).length(), 1e-3 * this.size, 1e-9);
    this.controls.target.copy(center);
    this.camera.position.copy(center).add(new THREE.Vector3(1.1, -2.1, 0.9).normalize().multiplyScalar(radius / Math.sin(0.5 * THREE.MathUtils.degToRad(this.camera.fov)) * 1.05));
    this.camera.near = radius * 1e-3;
    this.camera.far = radius * 400;
    this.camera.updateProjectionMatrix();
    this.redraw = true;
    this.viewed = { center, radius };
  }

  // A grid at the height of the ground: cells of a power of ten below the size of a body.
  addGround() {
    if (this.data.ground === null) return;
    const cell = 10 ** Math.floor(Math.log10(this.size)), { center, radius } = this.viewed;
    const cells = Math.min(2 * Math.ceil((6 * radius) / cell), 200);
    const grid = new THREE.GridHelper(cells * cell, cells, "#9aa5b1", "#c5ccd4");
    const height = this.data.ground - this.data.origin[2];
    grid.rotation.x = Math.PI / 2;
    grid.position.set(Math.round(center.x / cell) * cell, Math.round(center.y / cell) * cell, height);
    const plane = new THREE.Mesh(new THREE.PlaneGeometry(cells * cell, cells * cell),
                                 new THREE.MeshBasicMaterial({ color: "#dfe2dd", side: THREE.DoubleSide, transparent: true, opacity: 0.8, depthWrite: false }));
    plane.renderOrder = -1; // what is below shows through
    plane.position.copy(grid.position);
    this.scene.add(plane, grid);
    this.panel.cell = cell;
  }

  seek(time) {
    const { times } = this;
    if (!times.length) return;
    this.time = Math.min(Math.max(time, times[0]), times[times.length - 1]);
    const index = lastNotAfter(times, this.time), next = Math.min(index + 1, times.length - 1);
    const share = next > index ? (this.time - times[index]) / (times[next] - times[index]) : 0;
    this.frame = index;
    this.exact = index + (share > 1 - 1e-6 ? 1 : share);
    if (share > 1 - 1e-6) this.frame = next;
    this.dirty = true;
  }

  step(frames) {
    this.seek(this.times[Math.min(Math.max(this.frame + frames, 0), this.times.length - 1)]);
  }

  play(on) {
    if (on && this.time >= this.times[this.times.length - 1]) this.seek(this.times[0]);
    this.playing = on;
    this.panel.showPlaying(on);
  }

  tick(now) {
    requestAnimationFrame((next) => this.tick(next));
    const passed = Math.min(now - this.last, 250);
    this.last = now;
    const begin = performance.now();
    if (this.playing) {
      this.seek(this.time + 1e-3 * passed * this.speed);
      if (this.time >= this.times[this.times.length - 1]) this.play(false);
    }
    if (this.dirty) this.showState(now);
    if (this.renderer && (this.redraw || this.resized())) this.draw();
    this.work.push(performance.now() - begin);
    if (this.work.length > 600) this.work.shift();
  }

  showState(now) {
    this.dirty = false;
    this.redraw = true;
    const before = this.followed >= 0 ? this.bodies.center(this.followed) : null;
    this.bodies.show(this.exact);
    this.forces?.show(this.frame);
    const after = this.followed >= 0 ? this.bodies.center(this.followed) : null;
    if (this.renderer && before && after) {
      const move = after.sub(before);
      this.camera.position.add(move);
      this.controls.target.add(move);
    }
    this.panel.showTime();
    if (!this.playing || now - (this.written ?? 0) > LEGEND_INTERVAL) {
      this.written = now;
      this.plots.show(this.time);
      this.showContact();
    }
  }

  // Takes over the size of the view where it has changed.
  resized() {
    const { clientWidth: width, clientHeight: height } = this.panel.view, ratio = Math.min(window.devicePixelRatio, 2);
    const now = `${width} ${height} ${ratio}`;
    if (this.drawn === now || width < 1 || height < 1) return false;
    this.drawn = now;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    return true;
  }

  // Only where something has changed: a page that stands still costs nothing.
  draw() {
    this.resized();
    this.controls.update();
    this.redraw = false;
    this.renderer.render(this.scene, this.camera);
    this.forces.placeLabels(this.camera, this.panel.view.clientWidth, this.panel.view.clientHeight);
  }

  follow(thing) {
    this.followed = thing;
    const center = thing >= 0 ? this.bodies.center(thing) : null;
    if (!center || !this.renderer) return;
    const move = center.sub(this.controls.target);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.redraw = true;
  }

  pick(event) {
    const box = event.target.getBoundingClientRect(), caster = new THREE.Raycaster();
    const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    caster.setFromCamera(at, this.camera);
    const run = this.forces.pick(caster);
    this.selected = run < 0 ? -1 : this.contacts.key[run];
    this.showContact();
  }

  // The numbers of the chosen contact at the present time.
  showContact() {
    let found = -1;
    if (this.selected >= 0) this.contacts.at(this.frame, (run) => (found = this.contacts.key[run] === this.selected ? run : found));
    this.panel.showContact(this.selected >= 0, found);
  }

  // For tests and for the console: the pose of a link in the world, 16 numbers by columns.
  linkMatrix(body, link) {
    const found = this.data.bodies.find(({ name }) => name === body)?.links.find(({ name }) => name === link);
    return found ? this.bodies.matrices[found.track].toArray() : null;
  }
}

async function main() {
  const holder = document.getElementById("recording");
  const data = JSON.parse(holder.textContent);
  holder.remove();
  window.replay = new Replay(data);
  try {
    await window.replay.load();
    window.replay.ready = true;
  } catch (error) {
    document.getElementById("app").replaceChildren(element("p", "failed", `This recording cannot be shown: ${error.message}`));
    throw error;
  }
}

main();
