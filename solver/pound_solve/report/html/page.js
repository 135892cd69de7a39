"use strict";

const PAPER = 690; // width of a picture on paper [px]: A4 within the margins of page.css
const PRINT_SIZE = 8 / 10.5; // of texts on paper to those on the screen, see page.css
const LEAST = 0.8; // size to which a table shrinks before its texts are wrapped
const BESIDE = 600; // least width of a picture with the names of its curves beside it [px]
const NAMES = 210; // room for names beside pictures over time, whose axes are in line then [px]
const LONG = 24; // characters of a name that has no room there
const ROW = 19; // height of a line of names [px]

// What a cell is sorted by: the number that it begins with, then its text. Cells that begin with a text
// come after those with a number, and cells without a value last.
function sortKey(row, column) {
  const text = row.cells[column].textContent.trim();
  const [start] = /^[-+]?(\d+\.?\d*(e[-+]?\d+)?|inf\b)/i.exec(text) ?? [""];
  const value = Number(start.replace(/inf/i, "Infinity"));
  const none = ["", "-", "nan"].includes(text.toLowerCase());
  return { row, text, value, rank: none ? 2 : Number(start === "") };
}

function sorted(rows, column, way) {
  const compare = (a, b) => {
    if (a.rank !== b.rank) return a.rank - b.rank;
    if (a.value !== b.value) return way * (a.value < b.value ? -1 : 1);
    return way * a.text.localeCompare(b.text, "en", { numeric: true });
  };
  return rows.map((row) => sortKey(row, column)).sort(compare).map((key) => key.row);
}

// A click on the head of a column sorts its table: upwards, downwards, then as it was.
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0];
  const original = [...body.rows];
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.firstChild.addEventListener("click", () => {
    const next = { none: "ascending", ascending: "descending", descending: "none" }[head.ariaSort];
    heads.forEach((other) => { other.ariaSort = "none"; });
    head.ariaSort = next;
    body.append(...(next === "none" ? original : sorted(original, column, next === "ascending" ? 1 : -1)));
  }));
}

// A table wider than the paper is printed smaller; first its texts stay whole, then they are wrapped.
function shrinkTables() {
  for (const table of document.querySelectorAll("table")) {
    table.classList.add("measured");
    const scaleTo = (width) => {
      table.style.width = width;
      return PAPER / (table.offsetWidth * PRINT_SIZE);
    };
    const scale = Math.min(scaleTo("min-content"), Math.max(LEAST, scaleTo("max-content")));
    table.style.width = "";
    table.classList.remove("measured");
    if (scale < 1) table.style.fontSize = `${Math.floor(100 * scale)}%`;
  }
}

function restoreTables() {
  for (const table of document.querySelectorAll("table")) table.style.fontSize = "";
}

// Whether the name of each curve is listed: on paper, only those of curves that are visible.
function listedNames(figure, onPaper = false) {
  const hidden = (place) => figure.place.data[place].visible === "legendonly";
  return figure.traces.map((trace, place) => trace.showlegend !== false && !(onPaper && hidden(place)));
}

// Layout of a picture of a width: the names of the curves beside it, or below if they are long.
function arranged(figure, listed, width, height = width < BESIDE ? 320 : 400) {
  const names = figure.traces.filter((trace, place) => listed[place]).map((trace) => trace.name.length);
  const longest = Math.max(...names);
  if (!figure.named || (width >= BESIDE && longest <= LONG)) {
    const legend = { orientation: "v", x: 1.02, y: 1, yanchor: "top", yref: "paper", maxheight: 1, tracegroupgap: 0 };
    const right = figure.time && width >= BESIDE ? NAMES : 20;
    return { width, height, margin: { l: 70, r: right, t: 10, b: 50 }, legend };
  }
  const columns = Math.max(1, Math.floor((width - 80) / (6.5 * longest + 50)));
  const room = ROW * Math.min(12, Math.ceil(names.length / columns)) + 10;
  const below = { orientation: "h", x: 0, y: 0, yanchor: "bottom", yref: "container" };
  const legend = { ...below, maxheight: room, tracegroupgap: 0 };
  return { width, height: height + room, margin: { l: 70, r: 10, t: 30, b: 55 + room }, legend };
}

const roomOf = (figure) => figure.place.parentElement.clientWidth;

function draw(figure, touch) {
  const axis = (title, more) => ({
    title: { text: title }, gridcolor: "#e3e6e9", zeroline: !figure.equal, zerolinecolor: "#999",
    exponentformat: "E", minexponent: 5, ...more,
  });
  // ten colours, and other dashes for the next ten
  const dash = (place) => ["solid", "dash", "dot", "dashdot"][Math.floor(place / 10) % 4];
  const traces = figure.traces.map((trace, place) => ({
    type: "scatter", ...trace, line: { width: 1.5, dash: dash(place), ...trace.line },
  }));
  const type = figure.log ? { type: "log", exponentformat: "power" } : {};
  const rows = figure.rows.length ? {
    tickvals: [...figure.rows.keys()], ticktext: figure.rows, side: "right", automargin: true,
    range: [-0.5, figure.rows.length - 0.5], zeroline: false,
  } : {};
  const layout = {
    ...arranged(figure, listedNames(figure), roomOf(figure)),
    separators: ".", // none between thousands
    hovermode: figure.time && !figure.rows.length ? "x unified" : "closest",
    dragmode: touch ? false : "zoom", // a finger moves the page
    xaxis: axis(figure.x, { ...type, ...(figure.range ? { range: [...figure.range] } : {}) }),
    yaxis: axis(figure.y, { ...type, ...rows, ...(figure.equal ? { scaleanchor: "x", scaleratio: 1 } : {}) }),
    showlegend: figure.named,
  };
  // a wheel without the key Ctrl moves the page, or the names if there are many
  figure.place.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.target.closest(".legend")) event.stopPropagation();
  }, { capture: true });
  Plotly.newPlot(figure.place, traces, layout, { displaylogo: false, scrollZoom: !touch });
}

// All pictures over time show the same time as the one that was zoomed.
function link(figures) {
  let following = false;
  const follow = async (leader, change) => {
    if (following || !Object.keys(change).some((key) => key.startsWith("xaxis."))) return;
    following = true;
    const range = leader.place.layout.xaxis.range;
    const others = figures.filter((figure) => figure !== leader);
    await Promise.all(others.map((f) => Plotly.relayout(f.place, { "xaxis.range": [...range] })));
    following = false;
  };
  for (const figure of figures) figure.place.on("plotly_relayout", (change) => follow(figure, change));
}

function fit(figures, paper) {
  for (const figure of figures) {
    const listed = listedNames(figure, Boolean(paper));
    const layout = arranged(figure, listed, paper?.width ?? roomOf(figure), paper?.height);
    Plotly.update(figure.place, { showlegend: listed }, layout);
  }
}

function drawAll(figures) {
  const overTime = figures.filter((figure) => figure.time);
  const times = overTime.flatMap((f) => f.traces.flatMap((trace) => [trace.x[0], trace.x.at(-1)])).filter(Number.isFinite);
  const range = [Math.min(...times), Math.max(...times)]; // of numbers: an empty curve has none
  const touch = matchMedia("(pointer: coarse)").matches;
  figures.forEach((figure, number) => {
    figure.place = document.getElementById(`p${number + 1}`);
    figure.named = listedNames(figure).filter(Boolean).length > 1;
    if (figure.time) figure.range = range;
    if (figure.reach) figure.range = [0, figure.reach];
    draw(figure, touch);
  });
  link(overTime);
  addEventListener("resize", () => fit(figures));
  addEventListener("beforeprint", () => fit(figures, { width: PAPER, height: 268 })); // three with notes on a page
  addEventListener("afterprint", () => fit(figures));
}

addEventListener("beforeprint", shrinkTables);
addEventListener("afterprint", restoreTables);
const data = document.getElementById("figures");
if (data) drawAll(JSON.parse(data.textContent));
