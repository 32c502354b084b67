// Plots over one time axis, by hand, finger and key: those of the reports, and of the book's live page.
"use strict";

/**
 * Plots of which all show the same stretch of time. `colours` are names of the page's custom properties,
 * `status` is the element that says the stretch in view, `moved` hears of it.
 */
const timePlots = ({ colours: names, status, moved = () => {} }) => {
  // ---- numbers ---------------------------------------------------------------------------
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

  // ---- time ------------------------------------------------------------------------------
  const INCREMENTS = [];
  for (let e = -6; e < 0; e++) for (const m of [1, 2, 5]) INCREMENTS.push(Number(`${m}e${e}`));
  INCREMENTS.push(1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400, 28800,
    43200, 86400, 172800, 432000, 864000);
  let time = [0], first = 0, last = 0, view = [0, 0], clocked = false;
  /** Takes the samples' times; all of them are in view. */
  const over = samples => {
    time = samples;
    [first, last] = [time[0], time[time.length - 1]];
    view = [first, last];
    clocked = last - first > 180;
  };
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

  const colours = {};
  const readColours = () => {
    const style = getComputedStyle(document.documentElement);
    for (const name of names) colours[name] = style.getPropertyValue(`--${name}`).trim();
  };
  readColours();
  const colour = name => () => colours[name];

  const plots = [];
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
    moved(view, view[0] <= first && view[1] >= last);
  };
  const reset = () => show(first, last);
  const zoom = (factor, at = (view[0] + view[1]) / 2) =>
    show(at + (view[0] - at) * factor, at + (view[1] - at) * factor);
  const pan = share => {
    const by = share * (view[1] - view[0]);
    const held = Math.min(Math.max(by, first - view[0]), last - view[1]);
    show(view[0] + held, view[1] + held);
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
  /** A range with some room around it. */
  const padded = (u, low, high) => {
    if (low === null || high === null) return [0, 1];
    const room = (high - low || Math.abs(high) || 1) * 0.06;
    return [low - room, high + room];
  };
  /** A plot in its parent; `labelled` where the time stands below it. */
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

  /** Keeps the plots of an area as wide as it, and has its figure hear keys for one of them. */
  const attend = (figure, area, u) => {
    figure.addEventListener("keydown", event => keys(u, event));
    new ResizeObserver(() => {
      for (const { u } of plots) {
        const wide = u.root.parentElement.parentElement.clientWidth;
        if (wide > 0 && wide !== u.width) u.setSize({ width: wide, height: u.height });
      }
    }).observe(area);
  };
  /** The page's colours have changed. */
  const recolour = () => {
    readColours();
    for (const { u } of plots) u.redraw(false, true);
  };
  for (const [id, hand] of [["zoom-in", () => zoom(0.5)], ["zoom-out", () => zoom(2)], ["left", () => pan(-0.5)],
    ["right", () => pan(0.5)], ["reset", reset]]) {
    document.getElementById(id).addEventListener("click", hand);
  }
  return { over, plots, colour, draw, attend, recolour, show, announce, extremes, number };
};
