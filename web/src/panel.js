// The elements around the view: time slider, buttons, choices, numbers. Texts of a recording are only ever set as text.
import { MODE_COLORS } from "./colors.js";

const SPEEDS = [0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 5, 10];

export function element(tag, className = "", text = "") {
  const made = document.createElement(tag);
  made.className = className;
  made.textContent = text;
  return made;
}

function written(value, digits) {
  return Math.abs(value) < 1e-3 && value !== 0 ? value.toExponential(digits - 1) : value.toPrecision(digits);
}

function labelled(text, control) {
  const label = element("label", "", text);
  label.append(control);
  return label;
}

function choice(options, value, change) {
  const select = element("select");
  for (const [text, key] of options) select.append(new Option(text, key));
  select.value = value;
  select.addEventListener("change", () => change(select.value));
  return select;
}

function checkbox(on, change) {
  const box = element("input");
  Object.assign(box, { type: "checkbox", checked: on });
  box.addEventListener("change", () => change(box.checked));
  return box;
}

function range(minimum, maximum, step, value, change) {
  const slider = element("input");
  Object.assign(slider, { type: "range", min: minimum, max: maximum, step, value });
  slider.addEventListener("input", () => change(Number(slider.value)));
  return slider;
}

export class Panel {
  constructor(root, replay) {
    this.replay = replay;
    this.view = element("div", "view");
    this.canvas = element("canvas");
    this.labels = element("div", "labels");
    this.contact = element("table", "contact");
    this.contact.hidden = true;
    this.legend = element("div", "legend");
    this.view.append(this.canvas, this.labels, this.legend, this.contact);
    this.side = element("div", "side");
    this.choices = element("div", "choices");
    this.plots = element("div", "plots");
    this.side.append(this.choices, this.plots);
    this.bar = element("div", "bar");
    root.replaceChildren(this.view, this.side, this.bar);
    this.fillBar();
    window.addEventListener("keydown", (event) => this.key(event));
  }

  fillBar() {
    const { replay } = this;
    this.button = element("button", "play", "play");
    this.button.addEventListener("click", () => replay.play(!replay.playing));
    const back = element("button", "", "<"), on = element("button", "", ">");
    back.title = "one frame back (left)";
    on.title = "one frame on (right)";
    back.addEventListener("click", () => replay.step(-1));
    on.addEventListener("click", () => replay.step(1));
    this.slider = range(0, Math.max(replay.times.length - 1, 0), 1, 0, (frame) => replay.seek(replay.times[frame]));
    this.slider.id = "time";
    this.clock = element("output", "clock");
    const speed = choice(SPEEDS.map((value) => [`${value} x`, value]), 1, (value) => (replay.speed = Number(value)));
    this.bar.append(back, this.button, on, this.slider, this.clock, labelled("speed ", speed));
  }

  // The choices, once it is known what can be followed. @param showForces(side) plots one side, or with -1 the largest ones
  fill(things, sides, showForces) {
    const { replay } = this, follow = choice([["nobody", -1], ...things.map(({ name }, index) => [name, index])], -1, (value) => replay.follow(Number(value)));
    const plotted = choice([["the largest", -1], ...sides.map((side) => [replay.contacts.sideName(side), side])], -1, (value) => {
      showForces(Number(value));
      replay.dirty = true;
    });
    const again = () => (replay.dirty = true);
    const forces = (change) => (value) => {
      if (replay.forces) change(replay.forces, value);
      again();
    };
    const all = element("button", "", "view all");
    all.addEventListener("click", () => replay.renderer && replay.lookAtAll());
    this.choices.append(
      labelled("camera follows ", follow), all, labelled("plot normal forces of ", plotted),
      labelled("forces ", checkbox(true, forces((view, on) => (view.group.visible = on)))),
      labelled("cones ", checkbox(true, forces((view, on) => (view.conesShown = on)))),
      labelled("numbers ", checkbox(false, forces((view, on) => (view.numbers = on)))),
      labelled("arrows ", range(-2, 2, 0.05, 0, forces((view, value) => {
        view.factor = 10 ** value;
        this.showLegend();
      }))),
      labelled("bodies ", range(0.1, 1, 0.05, 1, (value) => {
        replay.bodies.setOpacity(value);
        again();
      })));
    follow.id = "follow";
  }

  showLegend() {
    const { replay } = this, { forces } = replay;
    this.legend.replaceChildren(...replay.data.modes.map((mode, index) => {
      const entry = element("span", "", mode);
      entry.style.color = MODE_COLORS[index];
      return entry;
    }));
    if (forces) this.legend.append(element("span", "", `arrow of ${replay.size.toPrecision(2)} m: ${(replay.size / forces.scale).toPrecision(3)} N`));
    if (this.cell) this.legend.append(element("span", "", `cell ${this.cell} m`));
  }

  showNotes(notes) {
    this.showLegend();
    const details = element("details", "notes");
    details.append(element("summary", "", `${this.replay.data.source}${notes.length ? ` -- ${notes.length} notes` : ""}`), ...notes.map((note) => element("p", "", note)));
    details.open = notes.length > 0 && notes.length < 3;
    this.side.append(details);
  }

  showPlaying(on) {
    this.button.textContent = on ? "pause" : "play";
  }

  showTime() {
    const { replay } = this, { times } = replay;
    this.slider.value = replay.frame;
    this.clock.textContent = `${replay.time.toFixed(4)} s of ${times[times.length - 1].toFixed(4)} s, frame ${replay.frame + 1} of ${times.length}`;
  }

  // @param run of the chosen contact, -1 where it is open now
  showContact(chosen, run) {
    this.contact.hidden = !chosen;
    if (!chosen) return;
    const { contacts, data } = this.replay, at = (list) => list.map((column) => written(column[run], 4)).join("  ");
    const rows = run < 0 ? [["contact", "not there at this time"]] : [
      ["on", contacts.sideName(contacts.sideA(run))], ["from", contacts.sideName(contacts.sideB(run))], ["mode", data.modes[contacts.mode[run]]],
      ["force [N]", at(contacts.force)], ["r_N [N]", written(contacts.normalForce[run], 4)], ["|r_T| [N]", written(contacts.tangentialForce[run], 4)],
      ["mu", written(contacts.friction[run], 4)], ["|r_T| / (mu r_N)", written(contacts.use(run), 3)], ["slip [m/s]", written(contacts.slip[run], 3)],
      ["gap [m]", written(contacts.gap[run], 3)], ["position [m]", contacts.position.map((column, axis) => written(column[run] + data.origin[axis], 5)).join("  ")],
      ["normal", at(contacts.normal)], ["id", contacts.id(run)]];
    this.contact.replaceChildren(...rows.map(([name, value]) => {
      const row = element("tr");
      row.append(element("th", "", name), element("td", "", value));
      return row;
    }));
  }

  key(event) {
    const { replay } = this;
    if (["SELECT", "INPUT"].includes(event.target.tagName) && event.target.id !== "time") return;
    const actions = { " ": () => replay.play(!replay.playing), ArrowLeft: () => replay.step(-1), ArrowRight: () => replay.step(1) };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }
}
