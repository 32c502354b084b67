// The plots of a report, and tables that sort.
"use strict";
(() => {
  const byId = id => document.getElementById(id);

  // ---- numbers, as the page was given them -------------------------------------------------
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  /** Steps between the lowest and the highest value in 16 bits; the last code is "missing". */
  const unpack = ({ low, high, codes }) => {
    const step = (high - low) / 65534;
    return Array.from(new Uint16Array(bytes(codes)), k =>
      k === 65535 ? null : k === 65534 ? high : low + k * step);
  };
  const unpackTime = t => t.every === undefined
    ? Array.from(new Float64Array(bytes(t.all)))
    : Array.from({ length: t.count }, (_, i) => t.start + i * t.every);

  // ---- tables ----------------------------------------------------------------------------
  for (const table of document.querySelectorAll("table.sortable")) {
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach(h => h.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const key = row => {
        const cell = row.cells[column];
        return cell.dataset.v === undefined ? cell.textContent : Number(cell.dataset.v);
      };
      const number = k => typeof k === "number";
      const rows = [...table.tBodies[0].rows].map(row => [key(row), row]);
      // What has no number stands last, either way.
      rows.sort(([a], [b]) => number(a) !== number(b) ? (number(a) ? -1 : 1)
        : (up ? 1 : -1) * (number(a) ? a - b : a.localeCompare(b, "en", { numeric: true })));
      rows.forEach(([, row]) => table.tBodies[0].append(row));
    }));
  }

  const holder = byId("data");
  if (!holder) {
    document.documentElement.dataset.ready = "yes";
    return;
  }
  const data = JSON.parse(holder.textContent);
  const { over, plots, colour, draw, attend, recolour, show, announce, extremes, number } = timePlots({
    colours: ["ink", "muted", "grid", "error", "simulated-0", "simulated-1", "simulated-2",
      "measured-0", "measured-1", "measured-2", "reference-0", "reference-1", "reference-2",
      "band-0", "band-1", "band-2"],
    status: byId("view"),
    moved: (view, whole) => {
      const mark = whole ? "" : `#t=${Number(view[0].toPrecision(9))},${Number(view[1].toPrecision(9))}`;
      try {
        history.replaceState(null, "", mark || location.pathname + location.search);
      } catch { /* a page without an address of its own has no history */ }
    },
  });
  over(unpackTime(data.time));
  const fromAddress = () => {
    const [, from, to] = /^#t=([-+.\de]+),([-+.\de]+)$/.exec(location.hash) || [];
    if (from !== undefined && Number(to) > Number(from)) show(Number(from), Number(to));
  };

  const build = (figure, panel) => {
    const area = figure.querySelector(".area");
    const caption = figure.querySelector(".range");
    const series = [], columns = [], bands = [], shown = [];
    const used = {};
    for (const line of panel.lines) {
      const n = used[line.role] = (used[line.role] ?? -1) + 1;
      const stroke = colour(`${line.role}-${n % 3}`);
      const width = line.role === "simulated" ? 1.25 : 2;
      const values = unpack(line.values);
      const at = columns.push(values);
      series.push({ label: line.name, stroke, width, points: { show: false }, value: (u, v) => number(v) });
      const all = [values];
      if (line.lowest) {
        const [low, high] = [unpack(line.lowest), unpack(line.highest)];
        all.push(low, high);
        const lowAt = columns.push(low), highAt = columns.push(high);
        for (const end of ["lowest", "highest"]) {
          series.push({ label: `${line.name}, ${end}`, stroke, width: 0.6, class: "edge", follows: at,
            points: { show: false }, value: (u, v) => number(v) });
        }
        bands.push({ series: [highAt, lowAt], fill: colour(`band-${n % 3}`) });
      }
      shown.push({ name: line.name, role: line.role, values, all });
    }
    const plot = { caption };
    const ours = shown.find(line => line.role === "simulated");
    const theirs = shown.find(line => line.role === "measured") ?? shown.find(line => line.role === "reference");
    const difference = ours && theirs &&
      ours.values.map((v, i) => v === null || theirs.values[i] === null ? null : v - theirs.values[i]);
    plot.u = draw(area, 210, !difference, series, columns, bands);
    plots.push(plot);
    const range = ([low, high]) => `${number(low)} … ${number(high)}`;
    plot.describe = () => "In view: " + shown.map(line => `${line.name} ${range(extremes(line.all))}`).join(", ") +
      (difference ? `, difference ${range(extremes([difference]))}` : "") + (panel.unit ? ` ${panel.unit}` : "");
    if (difference) {
      const error = { label: `${ours.name} less ${theirs.name}`, stroke: colour("error"), width: 1,
        points: { show: false }, value: (u, v) => number(v) };
      const u = draw(area, 104, true, [error], [difference], []);
      plots.push({ u, caption: document.createElement("p"), describe: () => "" });
    }
    attend(figure, area, plot.u);
  };
  const figures = [...document.querySelectorAll("figure.plot")];
  figures.forEach((figure, i) => build(figure, data.panels[i]));

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  addEventListener("hashchange", fromAddress);
  announce();
  fromAddress();
  document.documentElement.dataset.ready = "yes";
})();
