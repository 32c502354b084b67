// The live page of the book: the plant in a worker, sliders, plots, ledger, and the hash of every bit.
"use strict";
(() => {
  const byId = id => document.getElementById(id);
  const root = byId("live-plant");
  // The whole book on one page, to be printed, holds no plant.
  if (!root || /print\.html$/.test(location.pathname)) return;
  const made = (name, text, className) => {
    const element = document.createElement(name);
    element.textContent = text;
    if (className) element.className = className;
    return element;
  };
  if (typeof voltstepPlant === "undefined") {
    root.before(made("p", "The plant of this page is not built: `cargo xtask docs` builds it."));
    return;
  }
  root.hidden = false;
  // The book turns its pages with these.
  root.addEventListener("keydown", event => {
    if (/^Arrow/.test(event.key)) event.stopPropagation();
  });

  // ---- the plant, in a thread of its own ---------------------------------------------------
  /** Runs in a worker: this function's text is all that it has. */
  const work = () => {
    let plant, wanted = null, busy = false;
    const text = () => new TextDecoder().decode(new Uint8Array(plant.memory.buffer, plant.text(), plant.text_length()));
    const pause = () => new Promise(go => {
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = go;
      port2.postMessage(0);
    });
    /** So many rows at a time, at most: then it looks for a newer wish, for which it gives this one up. */
    const run = async (wish, step_ms, rows) => {
      const { id, car, cycle, knobs } = wish;
      if (!plant.begin(car, cycle, step_ms, ...knobs)) throw new Error(text());
      for (;;) {
        const state = plant.advance(rows);
        if (state === 2) throw new Error(text());
        if (state === 1) break;
        await pause();
        if (wanted) return;
      }
      plant.result();
      const result = JSON.parse(text());
      const columns = new Float32Array(plant.memory.buffer, plant.rows(), plant.rows_length()).slice();
      postMessage({ id, at: wish.at, step_ms, result, columns }, [columns.buffer]);
    };
    const loop = async () => {
      busy = true;
      while (wanted) {
        const wish = wanted;
        wanted = null;
        try {
          // The first in one go, or a slider that keeps moving would never show anything.
          await run(wish, 10, 0xffffffff);
          await pause();
          if (!wanted) await run(wish, 1, 300);
        } catch (error) {
          postMessage({ id: wish.id, error: error.message });
        }
      }
      busy = false;
    };
    onmessage = async ({ data }) => {
      if (data.wasm) {
        const unpacked = new Blob([data.wasm]).stream().pipeThrough(new DecompressionStream("gzip"));
        plant = (await WebAssembly.instantiate(await new Response(unpacked).arrayBuffer())).instance.exports;
        plant.catalogue();
        postMessage({ catalogue: JSON.parse(text()) });
        return;
      }
      wanted = data;
      if (!busy) loop();
    };
  };
  const worker = new Worker(URL.createObjectURL(new Blob([`(${work})()`], { type: "text/javascript" })));
  const wasm = Uint8Array.from(atob(voltstepPlant.wasm), c => c.charCodeAt(0)).buffer;
  worker.postMessage({ wasm }, [wasm]);

  // ---- knobs -------------------------------------------------------------------------------
  let cars, cycles, asked = 0;
  const chosen = () => cars[byId("car").value];
  const FACTORS = {
    mass: ["mass_kg", " kg", 0], drag: ["drag_coefficient", "", 3],
    capacity: ["capacity_ah", " A·h", 1], resistance: ["resistance_ohm", " mΩ", 1],
  };
  const factor = id => byId(id).valueAsNumber / 100;
  const tell = () => {
    const car = chosen();
    const said = (id, words) => {
      byId(`${id}-said`).textContent = words;
      byId(id).setAttribute("aria-valuetext", words);
    };
    for (const [id, [field, unit, digits]] of Object.entries(FACTORS)) {
      const value = car[field] * factor(id) * (unit === " mΩ" ? 1000 : 1);
      said(id, `${value.toFixed(digits)}${unit}${factor(id) === 1 ? "" : `, ${byId(id).value} %`}`);
    }
    const warm = car.temperature_c !== null;
    byId("warm").textContent = warm ? `Temperature, ${car.warm}` : "Temperature";
    said("temperature", warm ? `${byId("temperature").value.replace("-", "−")} °C` : "has none");
  };
  const ask = () => {
    tell();
    const knobs = [...Object.keys(FACTORS).map(factor), byId("temperature").valueAsNumber];
    const cycle = Number(byId("cycle").value);
    const preset = cycle === 0 && knobs.slice(0, 4).every(k => k === 1) &&
      [null, knobs[4]].includes(chosen().temperature_c);
    golden = preset ? voltstepPlant.golden[chosen().name] : undefined;
    worker.postMessage({ id: ++asked, at: performance.now(), car: Number(byId("car").value), cycle, knobs });
  };
  let golden;
  /** The sliders of a vehicle as it is. */
  const preset = () => {
    for (const id of Object.keys(FACTORS)) byId(id).value = 100;
    const { temperature_c, warm } = chosen();
    const slider = byId("temperature");
    slider.disabled = temperature_c === null;
    [slider.min, slider.max] = warm === "battery" ? [-10, 40] : [0, 100];
    slider.value = temperature_c ?? 25;
    ask();
  };
  byId("knobs").addEventListener("input", event => event.target.id === "car" ? preset() : ask());
  byId("knobs").addEventListener("reset", event => { event.preventDefault(); preset(); });
  byId("knobs").addEventListener("submit", event => event.preventDefault());

  // ---- plots -------------------------------------------------------------------------------
  const COLUMNS = 4, ROWS_PER_S = 10;
  const number = (value, digits) => value.toFixed(digits).replace("-", "−");
  const hands = timePlots({
    colours: ["muted", "grid", "error", "simulated-0", "reference-0", "battery"], status: byId("view"),
  });
  const line = (label, colour, digits) =>
    ({ label, stroke: hands.colour(colour), width: 1.25, points: { show: false },
      value: (u, v) => v === null || v === undefined ? "–" : number(v, digits) });
  const PLOTS = {
    speed: [line("to follow", "reference-0", 2), line("simulated", "simulated-0", 2)],
    power: [line("power", "battery", 1)],
    soc: [line("state of charge", "simulated-0", 2)],
    error: [line("10 ms less 1 ms", "error", 2)],
  };
  let duration = -1;
  const plotted = new Map();
  /** Draws columns over time, keeping the stretch in view while the cycle is the same. */
  const plot = columns => {
    const rows = columns.speed[0].length;
    if (rows !== duration) {
      duration = rows;
      hands.over(Array.from({ length: rows }, (_, i) => i / ROWS_PER_S));
    }
    const time = Array.from({ length: rows }, (_, i) => i / ROWS_PER_S);
    for (const [id, series] of Object.entries(PLOTS)) {
      const drawn = plotted.get(id);
      if (drawn) {
        drawn.setData([time, ...columns[id]]);
        continue;
      }
      const area = byId(id).querySelector(".area");
      const u = hands.draw(area, 150, true, series, columns[id], []);
      plotted.set(id, u);
      hands.plots.push({ u, caption: {}, describe: () => "" });
      hands.attend(byId(id), area, u);
    }
    hands.announce();
  };
  const column = (columns, k, scale = 1) =>
    Array.from({ length: columns.length / COLUMNS }, (_, i) => scale * columns[COLUMNS * i + k]);
  new MutationObserver(hands.recolour).observe(document.documentElement, { attributeFilter: ["class"] });

  // ---- figures, ledger, hash ---------------------------------------------------------------
  const J_PER_KWH = 3.6e6;
  /** What is no term of the balance, and what is too small for a line. */
  const BESIDE = ["throughput", "residual", "overcharge", "open_circuit_explicit"], LEAST = 2e-5;
  const GROUPS = {
    battery: ["electrochemical", "series_joule", "polarisation_joule", "capacitive"], auxiliary: ["auxiliary"],
    road: ["drag", "rolling", "brake", "potential", "kinetic"], step: ["numerical"],
  };
  const group = term => Object.keys(GROUPS).find(name => GROUPS[name].includes(term)) ?? "drive";
  const ledger = ({ terms, residual_rel }) => {
    const whole = terms.throughput;
    const widest = Math.max(...Object.entries(terms).map(([name, j]) => BESIDE.includes(name) ? 0 : Math.abs(j)));
    const rows = Object.entries(terms).filter(([name, j]) => !BESIDE.includes(name) && Math.abs(j) > LEAST * whole);
    byId("ledger").replaceChildren(...rows.map(([name, j]) => {
      const row = document.createElement("tr"), bar = document.createElement("td"), span = document.createElement("span");
      span.className = group(name);
      span.style.width = `${100 * Math.abs(j) / widest}%`;
      bar.className = "bar";
      bar.append(span);
      row.append(made("td", name.replaceAll("_", " ")), made("td", number(j / J_PER_KWH, 4), "n"),
        made("td", number(100 * j / whole, 2), "n"), bar);
      return row;
    }));
    byId("closes").textContent = `The ledger closes to ${Math.abs(residual_rel).toExponential(1).replace("-", "−")} ` +
      `of what the battery exchanged, ${number(whole / J_PER_KWH, 4)} kWh.`;
  };
  const figures = (result, error) => {
    const km = result.distance_m / 1000, kwh = result.energy_j / J_PER_KWH;
    const entries = {
      "Energy at the battery": `${number(kwh, 4)} kWh`,
      Consumption: km > 1e-3 ? `${number(1000 * kwh / km, 1)} Wh/km` : "–",
      "SOC at the end": `${number(100 * result.soc, 2)} %`,
      Distance: `${number(km, 3)} km`,
      "Step error, energy": error ? `${number(100 * error.energy_rel, 3)} %` : "…",
      "Step error, speed": error ? `${number(error.speed_rms_m_s * 1000, 2)} mm/s RMS` : "…",
    };
    byId("figures").replaceChildren(...Object.entries(entries).flatMap(([name, value]) => [made("dt", name), made("dd", value)]));
    byId("notes").textContent = result.limited_s > 0 ? `A limit acted during ${number(result.limited_s, 1)} s.` : "";
  };
  /** As `voltstep replay` defines it: less net energy than a quarter of what was exchanged is no measure. */
  const step_error = (coarse, fine) => {
    const rows = fine.columns.length / COLUMNS;
    let exchanged = 0, squares = 0;
    for (let i = 0; i < rows; i++) {
      exchanged += Math.abs(fine.columns[COLUMNS * i + 2]) / ROWS_PER_S;
      squares += (coarse.columns[COLUMNS * i + 1] - fine.columns[COLUMNS * i + 1]) ** 2;
    }
    const net = Math.max(Math.abs(fine.result.energy_j), 0.25 * exchanged);
    return { energy_rel: (coarse.result.energy_j - fine.result.energy_j) / net, speed_rms_m_s: Math.sqrt(squares / rows) };
  };
  const bits = hash => {
    byId("hash").textContent = hash ?? "…";
    const verdict = hash === undefined ? "" : golden === undefined
      ? "(a vehicle as it is, over UDDS, has one to compare with)"
      : golden === hash ? "= the microcontroller’s" : `≠ the microcontroller’s ${golden}`;
    byId("verdict").textContent = verdict;
    root.dataset.bits = hash === undefined || golden === undefined ? "" : golden === hash ? "same" : "different";
  };

  let coarse, times = {};
  const show = run => {
    const { columns, result, step_ms } = run;
    const isFine = step_ms === 1;
    if (!isFine) coarse = run;
    const compared = isFine ? step_error(coarse, run) : null;
    const [was, is] = [column(coarse.columns, 1, 1000), column(columns, 1, 1000)];
    plot({
      speed: [column(columns, 0), column(columns, 1)], power: [column(columns, 2, 1e-3)], soc: [column(columns, 3, 100)],
      error: [is.map((v, i) => isFine ? was[i] - v : null)],
    });
    figures(result, compared);
    ledger(result);
    bits(isFine ? result.hash : undefined);
    // After the frame in which it is seen.
    requestAnimationFrame(() => setTimeout(() => {
      times = isFine ? { ...times, fine: performance.now() - run.at } : { coarse: performance.now() - run.at };
      const said = [["10 ms", times.coarse], ["1 ms", times.fine]].filter(([, ms]) => ms !== undefined);
      byId("said").textContent = said.map(([step, ms]) => `${step} steps redrawn after ${ms.toFixed(0)} ms`).join(", ") + ".";
      [root.dataset.coarseMs, root.dataset.fineMs] = [times.coarse, times.fine].map(ms => ms?.toFixed(1) ?? "");
      root.dataset.shown = `${run.id} ${step_ms}`;
    }));
  };

  worker.onmessage = ({ data }) => {
    if (data.catalogue) {
      ({ cars, cycles } = data.catalogue);
      byId("car").replaceChildren(...cars.map(({ name }, i) => new Option(name, i)));
      byId("cycle").replaceChildren(...cycles.map(({ name, duration_s }, i) => new Option(`${name}, ${duration_s} s`, i)));
      preset();
    } else if (data.error) {
      byId("said").textContent = `Refused: ${data.error}`;
      root.dataset.shown = `${data.id} refused`;
    } else if (data.step_ms !== 1 || data.id === asked) {
      show(data);
    }
  };
})();
