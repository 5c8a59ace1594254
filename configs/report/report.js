// The page of a report: plots, tables and details of what data.js holds. Needs Chart.js; asks for nothing but pictures
// beside it.
"use strict";
(() => {
  const report = window.loom_report;
  const points = report.points.filter((p) => !p.failure);
  const by_key = new Map(report.points.map((p) => [p.key, p]));

  const costs = {
    wall: { name: "frame, ms (median)", of: (p) => p.frame.wall_ms.median },
    cpu: { name: "processor time of a frame, ms (median)", of: (p) => p.frame.cpu_ms.median },
    gpu: { name: "GPU time of a frame, ms (median)", of: (p) => p.frame.gpu_ms.median },
    anew: { name: "frame that makes everything anew, ms", of: (p) => p.frame.anew_ms || null },
    memory: { name: "textures and buffers, MiB", of: (p) => p.memory.textures_bytes / 1048576 },
  };
  const relmse = (output) => (p) => (p.error[output] ? p.error[output].relmse : null);
  const errors = {
    hdr: { name: "relMSE of radiance (hdr)", of: relmse("hdr") },
    indirect: { name: "relMSE of indirect irradiance", of: relmse("indirect") },
    bounce: { name: "relMSE of bounced irradiance", of: relmse("bounce") },
  };
  const chosen = { cost: "wall", error: "hdr", pipelines: new Set() };

  // Colours that people with any colour vision tell apart (Okabe and Ito 2008, Tol 2021), repeated where there are more.
  const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#332288", "#882255", "#117733",
    "#999933", "#aa4499", "#661100"];
  const pipelines = [...new Set(report.points.map((p) => p.pipeline))];
  const colour = (pipeline) => palette[pipelines.indexOf(pipeline) % palette.length];
  const grey = "#c3c7ce";

  const number = (v, digits = 3) => (v === null || v === undefined || !Number.isFinite(v) ? "–" : Number(v.toPrecision(digits)).toString());
  const element = (tag, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  };

  // ---- the front, for whatever cost and error are chosen
  function front_of(list, cost, error) {
    const order = list.filter((p) => cost(p) > 0 && error(p) > 0).sort((a, b) => cost(a) - cost(b) || error(a) - error(b));
    const front = [];
    for (const p of order) {
      const last = front[front.length - 1];
      if (!last || error(p) < error(last) || (error(p) === error(last) && cost(p) === cost(last))) front.push(p);
    }
    return front;
  }

  // ---- plots
  /// With some room at both ends: a point on the edge would be cut off.
  const log_axis = (title, values) => ({
    type: "logarithmic",
    min: Math.min(...values) / 1.25,
    max: Math.max(...values) * 1.25,
    title: { display: true, text: title },
    grid: { color: "#eceef2" },
    ticks: { callback: (value) => (/^[125]e/.test(Number(value).toExponential()) ? number(value) : "") },
  });

  function scatter(canvas, list, cost, error, titles, more) {
    const front = front_of(list, cost.of, error.of);
    const on_front = new Set(front);
    const shown = list.filter((p) => cost.of(p) > 0 && error.of(p) > 0);
    const coloured = (p) => on_front.has(p) || chosen.pipelines.has(p.pipeline);
    const points_set = {
      label: "points",
      data: shown.map((p) => ({ x: cost.of(p), y: error.of(p), point: p })),
      pointBackgroundColor: shown.map((p) => (coloured(p) ? colour(p.pipeline) : grey)),
      pointBorderColor: shown.map((p) => (on_front.has(p) ? "#1d2129" : coloured(p) ? colour(p.pipeline) : "#a9aeb8")),
      pointBorderWidth: shown.map((p) => (on_front.has(p) ? 1.5 : 1)),
      pointRadius: shown.map((p) => (p.no_indirect ? 8 : on_front.has(p) ? 6.5 : 4.5)),
      pointStyle: shown.map((p) => (p.no_indirect ? "rectRot" : "circle")),
      pointHoverRadius: 9,
      order: 0,
    };
    const line = { label: "front", type: "line", data: front.map((p) => ({ x: cost.of(p), y: error.of(p) })), stepped: "before",
      borderColor: "#1d2129", borderWidth: 1.3, pointRadius: 0, pointHitRadius: 0, order: 2 };
    const datasets = [points_set, line, ...more(shown, cost)];
    const every = datasets.flatMap((set) => set.data);
    const chart = new Chart(canvas, {
      type: "scatter",
      data: { datasets },
      options: {
        animation: false,
        maintainAspectRatio: false,
        scales: { x: log_axis(titles[0], every.map((p) => p.x)), y: log_axis(titles[1], every.map((p) => p.y)) },
        onClick: (event, hits) => {
          const hit = hits.find((h) => h.datasetIndex === 0);
          if (hit) show(chart.data.datasets[0].data[hit.index].point);
        },
        onHover: (event, hits) => { event.native.target.style.cursor = hits.some((h) => h.datasetIndex === 0) ? "pointer" : ""; },
        plugins: {
          legend: { labels: { filter: (item) => item.text !== "points", usePointStyle: true, pointStyle: "line" } },
          tooltip: {
            filter: (item) => item.datasetIndex === 0,
            callbacks: { label: (item) => [item.raw.point.label, `${number(item.raw.x)}, ${number(item.raw.y)}`] },
          },
        },
      },
    });
    return chart;
  }

  /// What does not depend on a pipeline: straight lines and the reference's own way to the truth.
  function landmarks(scene) {
    return (shown, cost) => {
      const key = chosen.error;
      const xs = shown.map(cost.of);
      const curve = chosen.cost === "memory" ? [] : scene.reference.convergence.map((s) => ({ x: 1e3 * s.seconds, y: s.relmse }));
      const ends = [Math.min(...xs), Math.max(...xs, ...(key === "hdr" ? curve.map((s) => s.x) : []))];
      const level = (label, value, colour_, dash) => ({ label, type: "line", data: ends.map((x) => ({ x, y: value })),
        borderColor: colour_, borderDash: dash, borderWidth: 1.2, pointRadius: 0, pointHitRadius: 0, order: 3 });
      const list = [level("indirect = 0", scene.without_indirect_relmse[key], "#b3261e", [7, 4])];
      if (key === "hdr") {
        if (curve.length) {
          list.push({ label: "path tracer, its error over time", type: "line", data: curve, borderColor: "#2459c4", borderWidth: 1.5,
            borderDash: [2, 3], pointRadius: 0, pointHitRadius: 0, order: 3 });
        }
        if (scene.aliasing_relmse > 0) list.push(level(`sampling alone, ${scene.samples} a pixel`, scene.aliasing_relmse, "#8a6d00", [3, 3]));
      }
      return list;
    };
  }

  const charts = [];
  function draw() {
    for (const chart of charts.splice(0)) chart.destroy();
    const cost = costs[chosen.cost], error = errors[chosen.error];
    for (const [index, scene] of report.scenes.entries()) {
      const list = points.filter((p) => p.scene === scene.name && p.camera === scene.camera);
      charts.push(scatter(document.getElementById(`plot-${index}`), list, cost, error, [cost.name, error.name], landmarks(scene)));
      const beside = document.getElementById(`flicker-${index}`);
      if (beside) {
        const flicker = { of: (p) => p.flicker };
        charts.push(scatter(beside, list.filter((p) => p.flicker > 0), flicker, error, ["flicker while the camera moves", error.name], () => []));
      }
    }
  }

  // ---- one point
  function show(p) {
    const dialog = document.getElementById("detail");
    const scene = report.scenes.find((s) => s.name === p.scene && s.camera === p.camera);
    const figure = (src, text) => element("figure", {}, element("a", { href: src, target: "_blank" }, element("img", { src, alt: text })), element("figcaption", { textContent: text }));
    const rows = [["frame, ms: median (p95)", `${number(p.frame.wall_ms.median, 4)} (${number(p.frame.wall_ms.p95, 4)})`],
      ["processor time, ms", `${number(p.frame.cpu_ms.median, 4)} (${number(p.frame.cpu_ms.p95, 4)})`],
      ["GPU time, ms", `${number(p.frame.gpu_ms.median, 4)} (${number(p.frame.gpu_ms.p95, 4)})`],
      ["everything anew, ms", number(p.frame.anew_ms, 4)], ["first frame, ms", number(p.frame.first_ms, 4)],
      ["textures and buffers, MiB", number(p.memory.textures_bytes / 1048576, 4)], ["flicker", number(p.flicker)]];
    for (const [output, e] of Object.entries(p.error)) {
      rows.push([`${output}: relMSE (95 %)`, `${number(e.relmse)} (${number(e.ci95[0])} – ${number(e.ci95[1])})`]);
      rows.push([`${output}: seeds' deviation, mean ratio, FLIP`, `${number(e.seed_sd, 2)}, ${number(e.mean_ratio)}, ${number(e.flip)}`]);
    }
    const table = element("table", {}, ...rows.map(([name, value]) => element("tr", {}, element("td", { textContent: name }), element("td", { textContent: value }))));
    dialog.replaceChildren(
      element("button", { className: "close", textContent: "close", onclick: () => dialog.close() }),
      element("h2", { textContent: p.label }),
      element("p", { className: "quiet", textContent: `${p.scene}, ${p.size[0]}×${p.size[1]}, ${p.samples} samples a pixel, median of ${p.frames} frames after one; ${p.seeds} seeds. ${p.device}. ${p.program}` }),
      element("div", { className: "pictures" }, figure(p.picture, "this point"), ...(scene ? [figure(scene.picture, `reference, ${scene.reference.spp} paths a pixel`)] : []), figure(p.heatmap, "FLIP error of radiance: black 0, pale yellow 1")),
      table,
      element("h3", { textContent: "Again" }),
      element("pre", { textContent: `${p.commands.measure}\n${p.commands.render}` }),
      element("p", {}, element("a", { href: `points/${p.key}.json`, textContent: "JSON" })));
    dialog.dataset.key = p.key;
    if (!dialog.open) dialog.showModal();
  }
  const link = (key, text) => element("button", { className: "link", textContent: text, onclick: () => show(by_key.get(key)) });

  // ---- tables
  function bounds_table(table, bound_name, cell) {
    const columns = table.bounds.length;
    const best = Array.from({ length: columns }, (_, i) => Math.min(...table.rows.map((r) => (r.cells[i] ? r.cells[i].value : Infinity))));
    return element("table", {},
      element("tr", {}, element("th", { textContent: bound_name }), ...table.bounds.map((b) => element("th", { textContent: number(b) }))),
      ...table.rows.map((row) => element("tr", {}, element("td", { textContent: row.pipeline }),
        ...row.cells.map((c, i) => (c === null ? element("td", { textContent: "–" }) : element("td", { className: c.value === best[i] ? "best" : "" }, link(c.key, cell(c.value))))))));
  }

  function scene_section(scene, index) {
    const list = points.filter((p) => p.scene === scene.name && p.camera === scene.camera);
    const flickers = list.some((p) => p.flicker > 0);
    const plot = (id) => element("div", { className: "plot" }, element("canvas", { id }));
    const section = element("section", {},
      element("h2", { textContent: scene.name + (scene.camera ? `, ${scene.camera}` : "") }),
      element("p", { className: "quiet", textContent: `${scene.size[0]}×${scene.size[1]}, ${scene.samples} samples a pixel, a frame is all of them. ` +
        `Reference: ${scene.reference.spp} paths a pixel in ${number(scene.reference.seconds)} s, its own relMSE ${number(scene.reference.noise_relmse)}. ` +
        `Sampling alone costs a relMSE of ${number(scene.aliasing_relmse)}.` }),
      element("div", { className: flickers ? "plots" : "plots single" }, plot(`plot-${index}`), ...(flickers ? [plot(`flicker-${index}`)] : [])));
    if (scene.tables) {
      section.append(element("h3", { textContent: "Error at equal time: relMSE of hdr that each pipeline reaches within so many milliseconds a frame" }),
        element("div", { className: "scroll" }, bounds_table(scene.tables.error_at_time, "at most, ms", (v) => number(v))),
        element("h3", { textContent: "Time at equal error: milliseconds a frame that each pipeline takes to come within this relMSE of hdr" }),
        element("div", { className: "scroll" }, bounds_table(scene.tables.time_at_error, "relMSE at most", (v) => number(v))));
    }
    const odd = report.odd_knobs.filter((k) => k.scene === scene.name);
    if (odd.length) {
      section.append(element("h3", { textContent: "No knobs of accuracy: more is better, then worse (or the other way round)" }),
        element("div", { className: "scroll" }, element("table", {},
          element("tr", {}, ...["parameter", "pipeline", "with", "relMSE of hdr at each value"].map((t) => element("th", { className: "text", textContent: t }))),
          ...odd.map((k) => element("tr", {}, element("td", { textContent: k.param }), element("td", { className: "text", textContent: k.pipeline }),
            element("td", { className: "text", textContent: k.with || "–" }),
            element("td", { className: "text" }, ...k.values.flatMap((v, i) => [link(k.keys[i], `${v}: ${number(k.errors[i])}`), "  "])))))));
    }
    return section;
  }

  const columns = [["scene", (p) => p.scene], ["point", (p) => p.label], ["frame, ms", (p) => p.frame.wall_ms.median], ["p95", (p) => p.frame.wall_ms.p95],
    ["CPU, ms", (p) => p.frame.cpu_ms.median], ["GPU, ms", (p) => p.frame.gpu_ms.median], ["all anew, ms", (p) => p.frame.anew_ms || null],
    ["MiB", (p) => p.memory.textures_bytes / 1048576], ["hdr", relmse("hdr")], ["indirect", relmse("indirect")], ["bounce", relmse("bounce")],
    ["mean ratio", (p) => p.error.indirect && p.error.indirect.mean_ratio], ["FLIP", (p) => p.error.hdr && p.error.hdr.flip], ["flicker", (p) => p.flicker]];
  function points_table(sort_by, down) {
    const table = document.getElementById("points");
    const value = columns[sort_by][1];
    const sorted = [...points].sort((a, b) => {
      const x = value(a), y = value(b);
      if (x === null || y === null) return (x === null) - (y === null);
      return (x < y ? -1 : x > y ? 1 : 0) * (down ? -1 : 1);
    });
    table.replaceChildren(
      element("tr", {}, ...columns.map(([name], i) => element("th", { className: i < 2 ? "text" : "", textContent: name, onclick: () => points_table(i, i === sort_by && !down) }))),
      ...sorted.map((p) => element("tr", { className: p.front ? "" : "dominated" }, ...columns.map(([, of], i) =>
        i === 1 ? element("td", { className: "text" }, link(p.key, p.label)) : element("td", { textContent: i === 0 ? p.scene : number(of(p)) })))));
  }

  // ---- the page
  function start() {
    document.title = `${report.name}: cost and error`;
    document.getElementById("name").textContent = report.name;
    document.getElementById("summary").textContent = report.summary;
    document.getElementById("made").textContent = `${report.points.length} of ${report.expected} points, by ${report.sweep}. ${report.devices.join("; ")}. ${report.programs.join("; ")}. ` +
      (report.static ? "Still scene: what does not change is kept, and a frame is what a moving camera costs." : "Everything is made anew in every frame.");
    const warn = (text) => document.getElementById("warnings").append(element("p", { className: "warning", textContent: text }));
    if (report.points.length < report.expected) warn(`${report.expected - report.points.length} points are not measured yet.`);
    if (report.programs.length > 1) warn("The points come from different builds of the program.");
    if (report.devices.length > 1) warn("The points come from different devices: their times cannot be compared.");
    for (const r of report.refused_references) warn(`The reference of ${r.scene} is refused: its own relMSE, ${number(r.noise_relmse)}, is not ten times below the best method's, ${number(r.best_relmse)} (${r.best}). About ${r.enough_spp} paths a pixel would do.`);
    for (const p of report.points.filter((q) => q.failure)) warn(`${p.label} on ${p.scene} failed: ${p.failure}`);

    for (const [id, options] of [["cost", costs], ["error", errors]]) {
      const select = document.getElementById(id);
      for (const [key, option] of Object.entries(options)) select.append(element("option", { value: key, textContent: option.name }));
      select.onchange = () => { chosen[id] = select.value; draw(); };
    }
    for (const pipeline of pipelines) {
      const mark = element("i");
      mark.style.background = colour(pipeline);
      const button = element("button", {}, mark, pipeline);
      button.ariaPressed = "false";
      button.onclick = () => {
        if (!chosen.pipelines.delete(pipeline)) chosen.pipelines.add(pipeline);
        button.ariaPressed = String(chosen.pipelines.has(pipeline));
        draw();
      };
      document.getElementById("pipelines").append(button);
    }
    document.getElementById("scenes").append(...report.scenes.map(scene_section));
    document.getElementById("detail").onclick = (event) => { if (event.target.id === "detail") event.target.close(); };
    points_table(8, false);
    draw();
    window.loom_charts = charts;
  }
  Chart.defaults.font.family = "system-ui, 'DejaVu Sans', sans-serif";
  start();
})();
