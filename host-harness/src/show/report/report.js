// The plots of a report over one time axis, and tables that sort.
"use strict";
(() => {
  const byId = id => document.getElementById(id);
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

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
  const number = v => {
    if (v === null || v === undefined) return "–";
    const size = Math.abs(v);
    if (size !== 0 && (size < 1e-3 || size >= 1e6)) return v.toExponential(2).replace("-", "−");
    if (size === 0) return "0";
    return v.toFixed(size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : 4).replace("-", "−");
  };

  /** So many decimals show a step of an axis. */
  const decimals = step => {
    for (let digits = 0; digits < 9; digits++) {
      const whole = step * 10 ** digits;
      if (Math.abs(whole - Math.round(whole)) < 1e-6 * whole) return digits;
    }
    return 9;
  };

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
  const time = unpackTime(data.time);
  const first = time[0], last = time[time.length - 1];
  let view = [first, last];

  // ---- time, as text ---------------------------------------------------------------------
  const INCREMENTS = [];
  for (let e = -6; e < 0; e++) for (const m of [1, 2, 5]) INCREMENTS.push(Number(`${m}e${e}`));
  INCREMENTS.push(1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400, 28800,
    43200, 86400, 172800, 432000, 864000);
  const clocked = last - first > 180;
  const clock = (t, step) => {
    const digits = decimals(step);
    if (!clocked) return t.toFixed(digits).replace("-", "−");
    const whole = Number(t.toFixed(digits)), minutes = Math.floor(whole / 60);
    const s = (whole - 60 * minutes).toFixed(digits).padStart(digits ? 3 + digits : 2, "0");
    const h = Math.floor(minutes / 60);
    return h > 0 ? `${h}:${String(minutes % 60).padStart(2, "0")}:${s}` : `${minutes}:${s}`;
  };
  const resolution = () => Math.max(1e-6, Math.min(1, 10 ** Math.floor(Math.log10((view[1] - view[0]) / 200))));

  // ---- what is shown ---------------------------------------------------------------------
  /** The first sample at or after a time. */
  const place = t => {
    let low = 0, high = time.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (time[middle] < t) low = middle + 1; else high = middle;
    }
    return low;
  };
  /** Lowest and highest of some columns over the samples in view: all of them, none left out. */
  const extremes = columns => {
    let low = Infinity, high = -Infinity;
    for (let i = place(view[0]); i < time.length && time[i] <= view[1]; i++) {
      for (const column of columns) {
        const v = column[i];
        if (v === null) continue;
        if (v < low) low = v;
        if (v > high) high = v;
      }
    }
    return low <= high ? [low, high] : [null, null];
  };

  let colours;
  const readColours = () => {
    colours = {};
    for (const name of ["ink", "muted", "grid", "error", "simulated-0", "simulated-1", "simulated-2",
      "measured-0", "measured-1", "measured-2", "reference-0", "reference-1", "reference-2",
      "band-0", "band-1", "band-2"]) colours[name] = css(`--${name}`);
  };
  readColours();
  const colour = name => () => colours[name];

  const plots = [];
  const status = byId("view");
  const announce = () => {
    const step = resolution();
    const unit = clocked ? "" : " s";
    status.textContent = `${clock(view[0], step)} to ${clock(view[1], step)}${unit}`;
    for (const plot of plots) plot.caption.textContent = plot.describe();
  };

  /** Shows a stretch of time in every plot. */
  const show = (from, to) => {
    const whole = last - first;
    const shortest = whole / Math.max(1, time.length - 1) * 2;
    let span = Math.min(whole, Math.max(to - from, shortest));
    if (!(span > 0)) span = whole;
    let start = Math.min(Math.max((from + to - span) / 2, first), last - span);
    if (from >= first && from + span <= last && to - from >= shortest) start = from;
    view = [start, start + span];
    for (const { u } of plots) u.setScale("x", { min: view[0], max: view[1] });
    announce();
    const whole_view = view[0] <= first && view[1] >= last;
    const mark = whole_view ? "" : `#t=${Number(view[0].toPrecision(9))},${Number(view[1].toPrecision(9))}`;
    try {
      history.replaceState(null, "", mark || location.pathname + location.search);
    } catch { /* a page without an address of its own has no history */ }
  };
  const reset = () => show(first, last);
  const zoom = (factor, at = (view[0] + view[1]) / 2) =>
    show(at + (view[0] - at) * factor, at + (view[1] - at) * factor);
  const pan = share => {
    const by = share * (view[1] - view[0]);
    const held = Math.min(Math.max(by, first - view[0]), last - view[1]);
    show(view[0] + held, view[1] + held);
  };
  const fromAddress = () => {
    const [, from, to] = /^#t=([-+.\de]+),([-+.\de]+)$/.exec(location.hash) || [];
    if (from !== undefined && Number(to) > Number(from)) show(Number(from), Number(to));
  };

  // ---- hands -----------------------------------------------------------------------------
  /** The reading cursor of every plot, one sample or ten to a side. */
  const read = (u, by) => {
    const at = u.cursor.idx ?? place((view[0] + view[1]) / 2);
    const to = Math.min(Math.max(at + by, place(view[0])), Math.max(place(view[1]) - 1, 0));
    u.setCursor({ left: u.valToPos(time[to], "x"), top: u.over.clientHeight / 2 }, true);
  };
  const keys = (u, event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const hand = {
      "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), "0": reset, Escape: reset,
      ArrowLeft: () => event.shiftKey ? read(u, -1) : pan(-0.2),
      ArrowRight: () => event.shiftKey ? read(u, 1) : pan(0.2),
      Home: () => pan(-Infinity), End: () => pan(Infinity),
    }[event.key];
    if (!hand) return;
    event.preventDefault();
    hand();
  };
  /** One finger moves, two stretch; up and down scrolls the page. */
  const fingers = u => {
    const down = new Map();
    let held = [];
    const timeAt = x => u.posToVal(x - u.over.getBoundingClientRect().left, "x");
    const hold = () => { held = [...down].map(([id, x]) => [id, timeAt(x)]); };
    u.over.addEventListener("pointerdown", event => {
      if (event.pointerType !== "touch") return;
      down.set(event.pointerId, event.clientX);
      hold();
    });
    u.over.addEventListener("pointermove", event => {
      if (!down.has(event.pointerId)) return;
      down.set(event.pointerId, event.clientX);
      const { left, width } = u.over.getBoundingClientRect();
      const [a, b] = held.map(([id, t]) => [down.get(id) - left, t]);
      let perPixel = (view[1] - view[0]) / width;
      if (b && Math.abs(b[0] - a[0]) > 10) perPixel = Math.max((b[1] - a[1]) / (b[0] - a[0]), 0) || perPixel;
      const from = Math.min(Math.max(a[1] - a[0] * perPixel, first), Math.max(last - perPixel * width, first));
      show(from, from + perPixel * width);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      u.over.addEventListener(end, event => { if (down.delete(event.pointerId)) hold(); });
    }
    u.over.addEventListener("wheel", event => {
      if (!event.ctrlKey) return; // the plain wheel scrolls the page
      event.preventDefault();
      zoom(event.deltaY > 0 ? 1.25 : 0.8, timeAt(event.clientX));
    }, { passive: false });
  };

  // ---- plots -----------------------------------------------------------------------------
  const axes = labelled => [
    {
      stroke: colour("muted"), grid: { stroke: colour("grid"), width: 1 }, ticks: { show: false },
      incrs: INCREMENTS, space: 70, gap: 4, size: labelled ? 24 : 6,
      values: (u, splits, axis, space, step) => splits.map(t => labelled ? clock(t, step) : ""),
    },
    {
      stroke: colour("muted"), grid: { stroke: colour("grid"), width: 1 }, ticks: { show: false },
      size: 52, gap: 6, space: 22,
      values: (u, splits, axis, space, step) => {
        const digits = decimals(step);
        const small = step < 1e-5;
        return splits.map(v => (small && v !== 0 ? v.toExponential(1) : v.toFixed(small ? 0 : digits)).replace("-", "−"));
      },
    },
  ];
  const padded = (u, low, high) => {
    if (low === null || high === null) return [0, 1];
    const room = (high - low || Math.abs(high) || 1) * 0.06;
    return [low - room, high + room];
  };
  const draw = (parent, height, labelled, series, columns, bands) => {
    const box = document.createElement("div");
    parent.append(box);
    const u = new uPlot({
      width: Math.max(parent.clientWidth, 200), height, series: [{ label: clocked ? "time" : "time [s]", class: "time",
        value: (u, t) => t === null ? "–" : clock(t, resolution()) }, ...series],
      bands, axes: axes(labelled),
      scales: { x: { time: false, range: () => view }, y: { range: padded } },
      padding: [6, 22, 0, 0],
      cursor: {
        sync: { key: "time", setSeries: false }, y: false, drag: { x: true, y: false, setScale: false },
        bind: { dblclick: () => () => { reset(); return null; } },
        points: { size: 7 },
      },
      legend: { live: true },
      hooks: {
        setSelect: [u => {
          if (u.select.width < 3) return;
          const { left, width } = u.select;
          u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
          show(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
        }],
        // The band of a line goes with it.
        setSeries: [(u, i, change) => {
          if (change.show === undefined || i === null) return;
          u.series.forEach((s, other) => {
            if (s.follows === i && s.show !== change.show) u.setSeries(other, { show: change.show });
          });
        }],
      },
    }, [time, ...columns], box);
    fingers(u);
    return u;
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
    figure.addEventListener("keydown", event => keys(plot.u, event));
    new ResizeObserver(() => {
      for (const { u } of plots) {
        const wide = u.root.parentElement.parentElement.clientWidth;
        if (wide > 0 && wide !== u.width) u.setSize({ width: wide, height: u.height });
      }
    }).observe(area);
  };
  const figures = [...document.querySelectorAll("figure.plot")];
  figures.forEach((figure, i) => build(figure, data.panels[i]));

  byId("zoom-in").addEventListener("click", () => zoom(0.5));
  byId("zoom-out").addEventListener("click", () => zoom(2));
  byId("left").addEventListener("click", () => pan(-0.5));
  byId("right").addEventListener("click", () => pan(0.5));
  byId("reset").addEventListener("click", reset);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    for (const { u } of plots) u.redraw(false, true);
  });
  addEventListener("hashchange", fromAddress);
  announce();
  fromAddress();
  document.documentElement.dataset.ready = "yes";
})();
