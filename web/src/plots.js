// Plots beside the view: one time axis, one cursor, a line at the present time; a click moves time.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { LINE_COLORS, MODE_COLORS } from "./colors.js";
import * as series from "./series.js";

const HEIGHT = 150; // of one plot [px]
const LARGEST_SIDES = 6;
const LEAST_RESIDUAL = 1e-17; // what a logarithmic axis shows of zero

const number = (value) => (value === null || value === undefined || !Number.isFinite(value) ? "--" : Number(value.toPrecision(4)).toString());

export class Plots {
  constructor(element, seek) {
    Object.assign(this, { element, seek, plots: [], sync: uPlot.sync("time") });
    this.observer = new ResizeObserver(() => this.plots.forEach(({ plot }) => plot.setSize({ width: this.width(), height: HEIGHT })));
    this.observer.observe(element);
  }

  width() {
    return Math.max(this.element.clientWidth - 4, 100);
  }

  // @param lines [{label, values, color}] @param options logarithmic, where {element to put it into}
  add(title, unit, times, lines, { logarithmic = false, fill = false } = {}) {
    const holder = document.createElement("div");
    holder.className = "plot";
    this.element.append(holder);
    const plot = new uPlot({
      title: unit ? `${title} [${unit}]` : title,
      width: this.width(),
      height: HEIGHT,
      scales: { x: { time: false }, y: logarithmic ? { distr: 3 } : {} },
      axes: [{ size: 26, font: "11px sans-serif", values: (_, ticks) => ticks.map((tick) => `${Number(tick.toPrecision(8))} s`) },
             { size: 58, font: "11px sans-serif", values: (_, ticks) => ticks.map((tick) => (tick === null ? "" : number(tick))) }],
      legend: { live: true },
      cursor: { sync: { key: "time", setSeries: false }, drag: { x: true, y: false } },
      series: [{ label: "time", value: (_, value) => (value === null ? "--" : `${value.toFixed(4)} s`) },
               ...lines.map((line, index) => ({
                 label: line.label, stroke: line.color ?? LINE_COLORS[index % LINE_COLORS.length], width: 1.2, points: { show: times.length === 1 },
                 fill: fill ? `${line.color}30` : undefined, value: (_, value) => number(value),
               }))],
    }, [times, ...lines.map((line) => line.values)], holder);
    const line = document.createElement("div");
    line.className = "now";
    plot.over.append(line);
    let pressed = 0;
    plot.over.addEventListener("mousedown", (event) => (pressed = event.clientX));
    plot.over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - pressed) > 3) return; // a stretch was marked, to be enlarged
      this.seek(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x"));
    });
    this.sync.sub(plot);
    const entry = { plot, line, times, holder };
    this.plots.push(entry);
    return entry;
  }

  remove(entry) {
    this.plots.splice(this.plots.indexOf(entry), 1);
    this.sync.unsub(entry.plot);
    entry.plot.destroy();
    entry.holder.remove();
  }

  // The line at a time; the legends show its values unless the mouse is in a plot.
  show(time) {
    for (const { plot, line, times } of this.plots) {
      const at = plot.valToPos(time, "x");
      line.hidden = !(at >= 0 && at <= plot.over.clientWidth);
      line.style.transform = `translateX(${at}px)`;
      if (plot.cursor.left < 0) plot.setLegend({ idx: plot.valToIdx ? plot.valToIdx(time) : nearest(times, time) }, false);
    }
  }
}

function nearest(times, time) {
  let first = 0, last = times.length - 1;
  while (last - first > 1) {
    const middle = (first + last) >> 1;
    if (times[middle] <= time) first = middle;
    else last = middle;
  }
  return time - times[first] <= times[last] - time ? first : last;
}

// Zero and what is not finite are gaps; a logarithmic axis has no zero.
const shown = (values, least = null) =>
  Array.from(values, (value) => (!Number.isFinite(value) ? null : least === null ? value : Math.max(value, least)));

export function addPlots(plots, data, times, contacts, reportTimes, reports) {
  let forces = null;
  const showForces = (sides) => {
    if (forces) plots.remove(forces);
    forces = plots.add("normal force", "N", times, sides.map((side) => ({ label: contacts.sideName(side), values: series.normalForce(contacts, side) })));
    if (plots.element.firstChild !== forces.holder) plots.element.prepend(forces.holder);
  };
  const largest = series.largestSides(contacts, LARGEST_SIDES);
  if (times.length && largest.length) showForces(largest);
  if (contacts.count) {
    plots.add("contacts", "", times, data.modes.map((mode, index) => ({ label: mode, values: series.modeCount(contacts, index), color: MODE_COLORS[index] })),
              { fill: true });
    plots.add("largest friction use |r_T| / (mu r_N)", "", times, [{ label: "use", values: series.frictionUse(contacts) }]);
  }
  if (reportTimes.length) {
    plots.add("residual E", "", reportTimes, [{ label: "E", values: shown(reports.residual, LEAST_RESIDUAL) }], { logarithmic: true });
    plots.add("deepest penetration", "m", reportTimes, [{ label: "depth", values: shown(reports.max_penetration) }]);
    plots.add("energy", "J", reportTimes, data.energies.map((name) => ({ label: name.replace("_", " "), values: shown(reports[name]) })));
  }
  if (!plots.plots.length) {
    const empty = document.createElement("p");
    empty.className = "empty";
    empty.textContent = "Neither contacts nor step reports in this recording: nothing to plot.";
    plots.element.append(empty);
  }
  return { showForces, largest };
}
