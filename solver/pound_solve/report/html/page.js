"use strict";

// A click on the head of a column sorts its table: upwards, downwards, then as it was.
// Cells without a number stay at the end.
function sorted(rows, column, way) {
  const key = (row) => row.cells[column].textContent;
  const numeric = rows[0].cells[column].className === "number";
  const compare = (a, b) => {
    if (!numeric) return way * key(a).localeCompare(key(b), "en", { numeric: true });
    const [p, q] = [Number.parseFloat(key(a)), Number.parseFloat(key(b))];
    if (Number.isNaN(p) || Number.isNaN(q)) return Number.isNaN(p) - Number.isNaN(q);
    return way * (p - q);
  };
  return [...rows].sort(compare);
}

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

const figures = document.getElementById("figures");
if (figures) {
  JSON.parse(figures.textContent).forEach((figure, number) => {
    const axis = (title, more) => ({ title: { text: title }, zeroline: false, gridcolor: "#e3e6e9", ...more });
    const layout = {
      margin: { l: 70, r: 20, t: 10, b: 50 },
      hovermode: figure.equal ? "closest" : "x unified",
      xaxis: axis(figure.x),
      yaxis: axis(figure.y, figure.equal ? { scaleanchor: "x", scaleratio: 1 } : {}),
      showlegend: figure.traces.length > 1,
    };
    // ten colours, and other dashes for the next ten
    const dash = (place) => ["solid", "dash", "dot", "dashdot"][Math.floor(place / 10) % 4];
    const traces = figure.traces.map((trace, place) => ({
      type: "scatter", ...trace, line: { width: 1.5, dash: dash(place), ...trace.line },
    }));
    Plotly.newPlot(`p${number + 1}`, traces, layout, { displaylogo: false, responsive: true, scrollZoom: true });
  });
}
