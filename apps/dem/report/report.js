// Draws a report from its data: { title, lead, figures, sections, making, timings, command, ... }.
// Texts of the data become text nodes, never markup.
"use strict";

const COLOURS = ["#1f5fa8", "#c2522a", "#2e7d4f", "#85479c", "#a87900", "#3f4a54", "#16908c", "#a62c5e",
                 "#6f8f1d", "#5a6fd0", "#8b5a3c", "#d07aa8"];
const MARKS = ["circle", "rect", "triangle", "rectRot", "crossRot", "star"];
const MUTED = "#55606b", GRID = "#e6e3db", AXIS_WIDTH = 84;

// ---- Elements

/// el("p", {class: "note"}, "text", child, ...)
function el(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/// A table under a name of its own. Cells are texts, or pictures; those that are numbers stand at the right.
function table(name, columns, rows) {
  const is_number = text => /^[−-]?[\d. ]+( \D{1,3})?$/.test(text);
  const cell = content => {
    if (content?.pictures) return el("td", { class: "pictures" }, ...content.pictures.map(thumbnail));
    const text = String(content ?? "");
    return el("td", is_number(text) ? { class: "number" } : {}, text);
  };
  const heading = (name, i) => {
    const number = rows.some(row => is_number(String(row[i] ?? "")));
    return el("th", { scope: "col", ...(number ? { class: "number" } : {}) }, name);
  };
  const head = columns.length ? [el("thead", {}, el("tr", {}, ...columns.map(heading)))] : [];
  const body = el("tbody", {}, ...rows.map(row => el("tr", {}, ...row.map(cell))));
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": name },
            el("table", columns.length > 5 ? { class: "full" } : {}, ...head, body));
}

function image(picture, attributes = {}) {
  const { src, alt, width, height } = picture;
  const kind = Math.max(width, height) < 400 ? "pixels" : "";
  return el("img", { src, alt, width, height, class: kind, draggable: "false", ...attributes });
}

function thumbnail(picture) {
  const side = 84, { aspect } = picture;
  const width = aspect > 1 ? side : Math.max(8, side * aspect);
  const height = aspect > 1 ? Math.max(8, side / aspect) : side;
  const img = image(picture, { class: "thumbnail", title: picture.label });
  img.width = Math.round(width);
  img.height = Math.round(height);
  return img;
}

// ---- Pictures

function frame(aspect, ...children) {
  const box = el("div", { class: "frame" }, ...children);
  box.style.setProperty("--aspect", aspect);
  return box;
}

function swipe(section) {
  const { before, after } = section;
  const slider = el("input", { type: "range", min: 0, max: 100, step: 1, value: 50,
                               "aria-label": `Divider: ${before.label} at its left, ${after.label} at its right` });
  const box = frame(section.aspect, image(before), image(after, { class: "after" }),
                    el("span", { class: "tag left" }, before.label), el("span", { class: "tag right" }, after.label),
                    el("span", { class: "divider" }), slider);
  const move = () => {
    box.style.setProperty("--at", `${slider.value}%`);
    slider.setAttribute("aria-valuetext", `${slider.value} % ${before.label}`);
  };
  slider.addEventListener("input", move);
  move();
  return [box, el("p", { class: "hint" }, "Drag the line, or use the arrow keys.")];
}

function map(section) {
  const parts = [frame(section.aspect, image(section.picture))];
  if (section.key)
    parts.push(el("ul", { class: "key" }, ...section.key.map(([name, colour]) => {
      const patch = el("i");
      patch.style.background = colour;
      return el("li", {}, patch, name);
    })));
  if (section.scale) {
    const { low, high, unit, colours } = section.scale;
    const bar = el("i");
    bar.style.background = `linear-gradient(90deg, ${colours.join(",")})`;
    const middle = (low + high) / 2;
    parts.push(el("div", { class: "scale" }, bar,
                  ...[low, middle, high].map(v => el("span", {}, `${number(v)} ${unit}`))));
  }
  return parts;
}

// ---- Charts

const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/// 1234.5 -> "1 235", 0.0123 -> "0.0123", 3e9 -> "3·10⁹"; `largest`: the first to be a power.
function number(value, largest = 1e7) {
  if (value === null || !Number.isFinite(value)) return "";
  const size = Math.abs(value);
  if (size !== 0 && (size >= largest || size < 1e-3)) {
    const power = Math.floor(Math.log10(size) + 1e-9), digits = value / 10 ** power;
    const raised = [...String(power)].map(c => c === "-" ? "⁻" : SUPERSCRIPT[c]).join("");
    return (Math.abs(digits - 1) < 1e-6 ? "" : `${+digits.toPrecision(3)}·`) + `10${raised}`;
  }
  const rounded = size >= 1000 ? Math.round(value) : +value.toPrecision(4);
  return (rounded < 0 ? "−" : "") + String(Math.abs(rounded)).replace(/\B(?<!\.\d*)(?=(\d{3})+(?!\d))/g, " ");
}

/// Whether a logarithmic axis names a value: 1, 2, 3, 5, 7 over a decade, 1 and 3 over two, else
/// powers of ten.
function named_on_log({ min, max }, value) {
  const decades = Math.log10(max / min);
  const digit = +(value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toFixed(6);
  return (decades > 2.5 ? [1] : decades > 1.3 ? [1, 3] : [1, 2, 3, 5, 7]).includes(digit);
}

/// `spec`: label, log, reversed, ticks, and the values of a logarithmic axis.
function axis(spec, extra = {}) {
  const scale = { type: spec.log ? "logarithmic" : "linear", reverse: Boolean(spec.reversed),
                  title: { display: true, text: spec.label, color: MUTED }, grid: { color: GRID, borderColor: MUTED },
                  ticks: { color: MUTED, maxRotation: 0, autoSkipPadding: 12, callback: value => number(value) },
                  ...extra };
  if (spec.ticks?.length) {
    scale.afterBuildTicks = built => { built.ticks = spec.ticks.map(value => ({ value })); };
    scale.min = Math.min(...spec.ticks);
    scale.max = Math.max(...spec.ticks);
  } else if (spec.log) {
    // No further than the data: by itself the axis would begin and end at powers of ten.
    scale.min = Math.min(...spec.values) / 1.2;
    scale.max = Math.max(...spec.values) * 1.2;
    scale.ticks.callback = function (value) { return number(value, this.max >= 1e7 ? 1000 : 1e7); };
    scale.afterBuildTicks = built => {
      const named = built.ticks.filter(tick => named_on_log(built, tick.value));
      if (named.length > 1) built.ticks = named;
    };
  }
  return scale;
}

/// An axis of amounts, as wide as every other one, so that charts below each other line up.
function upright(spec, extra = {}) {
  const scale = axis(spec, { afterFit: built => { built.width = AXIS_WIDTH; }, ...extra });
  scale.ticks.autoSkip = Boolean(spec.log);
  scale.ticks.maxTicksLimit = extra.maxTicks ?? 8;
  return scale;
}

const category = (label, labels) => ({ type: "category", labels, grid: { display: false, borderColor: MUTED },
                                       title: { display: Boolean(label), text: label, color: MUTED },
                                       ticks: { color: MUTED, maxRotation: 60, autoSkip: false } });

/// A canvas whose place is kept before anything is drawn on it.
function chart(config, label, height) {
  const canvas = el("canvas", { role: "img", "aria-label": label });
  const box = el("div", { class: "chart" }, canvas);
  box.style.height = `${height}px`;
  const many = config.data.datasets.length;
  config.options = { animation: false, maintainAspectRatio: false, normalized: true,
                     interaction: { mode: "nearest", intersect: false }, ...config.options };
  config.options.plugins = {
    legend: { display: many > 1, position: "top", align: "start",
              labels: { usePointStyle: true, boxWidth: 8, boxHeight: 7, padding: 10, color: "#252b31" } },
    ...config.options.plugins };
  waiting.push(() => new Chart(canvas, config));
  return box;
}
const waiting = [];  // drawn once their places stand in the page

function line_dataset(series, i) {
  const colour = COLOURS[i % COLOURS.length];
  return { label: series.name, data: series.x.map((x, j) => ({ x, y: series.y[j] })), parsing: false,
           showLine: series.line, borderColor: colour, backgroundColor: colour, borderWidth: 1.8, tension: 0,
           borderDash: series.dashed ? [6, 4] : [], pointRadius: series.marks ? 3 : 0, pointHitRadius: 8,
           pointStyle: series.marks ? MARKS[i % MARKS.length] : "line" };
}

const tooltip = (x, y) => ({ callbacks: {
  title: items => items.length ? `${x}: ${number(items[0].parsed.x)}` : "",
  label: item => `${item.dataset.label}: ${number(item.parsed.y)} (${y})` } });

function lines(section) {
  const { x, y, series, title, note } = section;
  x.values = series.flatMap(s => s.x);
  y.values = series.flatMap(s => s.y);
  const rows = series.flatMap(s => s.x.map((value, i) => [s.name, number(value), number(s.y[i])]));
  return [chart({ type: "line", data: { datasets: series.map((s, i) => line_dataset(s, i)) },
                  options: { scales: { x: axis(x), y: upright(y) },
                             plugins: { tooltip: tooltip(x.label, y.label) } } },
                `${title}. ${note}`, series.length > 4 ? 440 : 330),
          values(["", x.label, y.label], rows)];
}

function histogram(section) {
  const { x, y, low, high, counts, series, title, note } = section;
  const width = (high - low) / counts.length;
  const edges = [...counts, counts.at(-1)].map((count, i) => ({ x: low + i * width, y: count }));
  const area = { label: y.label, data: edges, parsing: false, stepped: "before", fill: "origin", pointRadius: 0,
                 borderColor: COLOURS[0], backgroundColor: "#1f5fa833", borderWidth: 1.2, pointStyle: "rect" };
  const rows = counts.map((count, i) => [`${number(low + i * width)} to ${number(low + (i + 1) * width)}`, count]);
  return [chart({ type: "line", data: { datasets: [area, ...series.map((s, i) => line_dataset(s, i + 1))] },
                  options: { scales: { x: axis(x, { min: low, max: high }), y: upright(y, { min: 0 }) },
                             plugins: { tooltip: tooltip(x.label, y.label) } } },
                `${title}. ${note}`, 330),
          values([x.label, y.label], rows)];
}

function bars(section) {
  const { x, y, classes, series, counts, counts_label, title, note } = section;
  const label = item => `${item.dataset.label}: ${number(item.parsed.y)}`;
  const plugins = { tooltip: { callbacks: { label } } };
  const shape = { categoryPercentage: 0.75, maxBarThickness: 72, pointStyle: "rect" };
  const datasets = series.map((s, i) => ({ label: s.name, data: s.values, backgroundColor: COLOURS[i], ...shape }));
  const parts = [];
  if (series.length)
    parts.push(chart({ type: "bar", data: { labels: classes, datasets },
                       options: { scales: { x: category(x.label, classes), y: upright(y) }, plugins } },
                     `${title}. ${note}`, 270));
  const below = { label: counts_label, data: counts, backgroundColor: "#9aa3ab", ...shape };
  const count_axis = upright({ label: counts_label }, { beginAtZero: true, maxTicks: series.length ? 3 : 8 });
  parts.push(chart({ type: "bar", data: { labels: classes, datasets: [below] },
                     options: { scales: { x: category(series.length ? "" : x.label, classes), y: count_axis },
                                plugins } },
                   `${title}: ${counts_label} in each class`, series.length ? 120 : 300));
  parts.push(values([x.label, ...series.map(s => `${s.name}, ${y.label}`), counts_label],
                    classes.map((name, i) => [name, ...series.map(s => number(s.values[i])), counts[i]])));
  return parts;
}

/// The numbers behind a chart, for those who cannot see it or want to copy them.
function values(columns, rows) {
  return el("details", {}, el("summary", {}, "Values"), table("Values", columns, rows));
}

// ---- The page

const KINDS = { swipe, map, lines, histogram, bars,
                table: section => [table(section.title, section.columns, section.rows)] };

/// Pictures stand beside pictures, charts and narrow tables beside each other; wide tables, and what
/// is left over, take the whole width.
function mark_wide(sections) {
  const kind = section => !section ? "" : ["swipe", "map"].includes(section.kind) ? "picture"
                        : section.columns?.length > 5 ? "table" : "chart";
  let before = 0;  // of the same kind, in this row of cards
  sections.forEach((section, i) => {
    before = kind(section) === kind(sections[i - 1]) ? before + 1 : 0;
    section.wide = kind(section) === "table" ||
                   before % 2 === 0 && kind(sections[i + 1]) !== kind(section);
  });
}

function draw_section(section) {
  const wide = section.wide ? " wide" : "";
  return el("section", { class: `card ${section.kind}${wide}` }, el("h2", {}, section.title),
            ...(section.note ? [el("p", { class: "note" }, section.note)] : []), ...KINDS[section.kind](section));
}

function draw(data) {
  document.title = data.title;
  mark_wide(data.sections);
  const page = document.getElementById("page");
  const figures = data.figures.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value)));
  page.append(
      el("header", {}, el("h1", {}, data.title), el("p", { class: "lead" }, data.lead),
         el("dl", { class: "figures" }, ...figures)),
      ...data.sections.map(draw_section),
      el("section", { class: "card wide making" }, el("h2", {}, "How it was made"),
         el("pre", { tabindex: "0" }, data.command),
         el("div", { class: "columns" }, table("Inputs, outputs, settings", [], data.making),
            table("Times", ["step", "time"], data.timings))),
      el("footer", {}, `dem ${data.version}, ${data.made}. This file fetches nothing.`));
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  for (const start of waiting) start();
}

draw(JSON.parse(document.getElementById("data").textContent));
