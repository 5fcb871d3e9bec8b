// Draws the figures of the page's data, and tells which point was chosen.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const charts = new Map();  // element -> its figure, colours still by name
  const fine = matchMedia("(pointer: fine)").matches;
  const config = { displayModeBar: false, responsive: true, doubleClick: "reset" };
  const NS = "http://www.w3.org/2000/svg";
  const MARKERS = {
    circle: "M11,6a4,4 0 1,0 8,0a4,4 0 1,0 -8,0", square: "M11.5,2.5h7v7h-7z", "triangle-up": "M15,1.5l4.5,8h-9z",
    diamond: "M15,1l5,5l-5,5l-5,-5z", "triangle-down": "M15,10.5l4.5,-8h-9z",
    cross: "M13.5,1.5h3v3h3v3h-3v3h-3v-3h-3v-3h3z", x: "M11,3l1,-1l3,3l3,-3l1,1l-3,3l3,3l-1,1l-3,-3l-3,3l-1,-1l3,-3z",
  };
  const DASHES = { solid: "", dash: "7,4", dashdot: "7,3,2,3", longdash: "10,3", dot: "2,3", longdashdot: "10,3,2,3" };

  const made = (tag, attributes = {}, ...children) => {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
  };
  const drawnMark = (trace) => {
    const svg = document.createElementNS(NS, "svg");
    svg.setAttribute("width", 30); svg.setAttribute("height", 12); svg.setAttribute("aria-hidden", "true");
    const add = (tag, attributes) => {
      const part = document.createElementNS(NS, tag);
      for (const [name, value] of Object.entries(attributes)) part.setAttribute(name, value);
      svg.append(part);
    };
    if (trace.type === "bar") {
      add("rect", { x: 8, y: 0, width: 14, height: 12, rx: 2, style: `fill: ${trace.marker.color}` });
      return svg;
    }
    if (trace.mode.includes("lines")) {
      const style = `stroke: ${trace.line.color}; stroke-width: ${trace.line.width}; stroke-dasharray: ${DASHES[trace.line.dash] || "none"}`;
      add("line", { x1: 0, x2: 30, y1: 6, y2: 6, style });
    }
    if (trace.mode.includes("markers")) add("path", { d: MARKERS[trace.marker.symbol], style: `fill: ${trace.marker.color}` });
    return svg;
  };

  // Colours: var(--name) wherever it stands in a figure is what the style sheet says now.
  const painted = (value, style) => {
    if (typeof value === "string") {
      const name = /^var\((--[\w-]+)\)$/.exec(value);
      return name ? style.getPropertyValue(name[1]).trim() : value;
    }
    if (Array.isArray(value)) return typeof value[0] === "number" ? value : value.map((each) => painted(each, style));
    if (value && typeof value === "object") {
      return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, painted(each, style)]));
    }
    return value;
  };
  const dressed = (layout, style) => {
    const broken = ({ ticktext }) => (ticktext ? { ticktext: ticktext.map((text) => text.replace(/ (?=[^ ]+$)/, "<br>")) } : {});
    const axis = (own, names) => ({
      gridcolor: style.getPropertyValue("--grid").trim(), linecolor: style.getPropertyValue("--rule").trim(),
      showline: true, ticks: "outside", ticklen: 4, tickcolor: style.getPropertyValue("--rule").trim(),
      fixedrange: !fine, ...own, ...names, title: { standoff: 8, font: { size: 13 }, ...own.title },
    });
    return {
      ...layout, xaxis: axis(layout.xaxis, broken(layout.xaxis)), yaxis: axis(layout.yaxis), dragmode: fine ? "zoom" : false,
      margin: { l: 48, r: 10, t: 8, b: 40, ...layout.margin }, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: style.getPropertyValue("--ink").trim() },
      hoverlabel: { bgcolor: style.getPropertyValue("--raised").trim(), bordercolor: style.getPropertyValue("--rule").trim(),
        font: { size: 13, color: style.getPropertyValue("--ink").trim() }, align: "left" },
    };
  };
  // Bands, and what is said of a point, are worked out here: as data they would be most of the page.
  const short = (value) => String(Number(value.toPrecision(4)));
  // Axes say their unit last, in brackets: "makespan (ms)".
  const unitOf = ({ title }) => { const unit = /\(([^()]+)\)$/.exec(title?.text ?? ""); return unit ? ` ${unit[1]}` : ""; };
  const texts = ({ name, x, y, meta }, { xaxis, yaxis }) => x.map((at, n) => {
    const place = xaxis.ticktext && xaxis.tickvals.includes(at) ? xaxis.ticktext[xaxis.tickvals.indexOf(at)] : short(at);
    const [low, high] = meta ? [short(meta.low[n]), short(meta.high[n])] : [];
    return `<b>${name}</b><br>at ${place}${unitOf(xaxis)}: ${short(y[n])}${low !== high ? ` (${low} to ${high})` : ""}${unitOf(yaxis)}`;
  });
  const band = ({ name, legendgroup, x, meta }) => ({
    type: "scatter", name, legendgroup, mode: "lines", line: { width: 0 }, hoverinfo: "skip", fill: "toself", fillcolor: meta.band,
    x: [...x, ...[...x].reverse()], y: [...meta.high, ...[...meta.low].reverse()],
  });
  const completed = (trace, layout) => {
    if (trace.hoverinfo === "skip") return [trace];
    const said = trace.type === "bar" && trace.text ? trace.text : texts(trace, layout);
    const told = { hovertext: said, hovertemplate: "%{hovertext}<extra></extra>" };
    if (trace.type === "bar") Object.assign(told, { text: null, textposition: "none" });
    return [...(trace.meta?.band ? [band(trace)] : []), { ...trace, ...told }];
  };
  const draw = (element) => {
    const figure = charts.get(element), style = getComputedStyle(document.documentElement);
    const traces = figure.data.flatMap((trace) => completed(trace, figure.layout))
      .map((trace) => ({ ...painted(trace, style), visible: !figure.hidden?.has(trace.legendgroup) }));
    return Plotly.react(element, traces, dressed(painted(figure.layout, style), style), config);
  };
  const show = (element, figure) => {
    charts.set(element, figure);
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", figure.alt);
    if (!element.on) near.observe(element);  // plotly gives it "on" when it is drawn first
    else draw(element);
  };
  // What comes near the window is drawn first: pages with many panels open as fast as others.
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) if (isIntersecting) begin(target);
  }, { rootMargin: "800px" });
  const begin = (element) => {
    near.unobserve(element);
    draw(element);
    element.on("plotly_click", (event) => {
      const number = event.points.map((point) => point.customdata).find((each) => each !== undefined && each !== null);
      if (number !== undefined) document.dispatchEvent(new CustomEvent("chosen", { detail: number }));
    });
  };
  // The rest follows while there is nothing else to do; what is folded, when it is opened.
  const isFolded = (element) => element.closest("details:not([open])");
  const idle = window.requestIdleCallback ?? ((task) => setTimeout(task, 50));
  const beginRest = () => {
    const next = [...charts.keys()].find((element) => !element.on && !isFolded(element));
    if (next) { begin(next); idle(beginRest); }
  };
  addEventListener("load", () => idle(beginRest));
  const drop = (element) => { near.unobserve(element); Plotly.purge(element); charts.delete(element); };

  // A legend for all panels of a figure: its buttons hide and show curves.
  const legend = (place, figures, title) => {
    const traces = new Map();
    for (const figure of figures) for (const trace of figure.data) traces.set(trace.legendgroup, trace);
    const hidden = new Set();
    const buttons = [...traces].map(([name, trace]) => {
      const button = made("button", { type: "button", "aria-pressed": "true" }, drawnMark(trace), name);
      button.addEventListener("click", () => {
        hidden.has(name) ? hidden.delete(name) : hidden.add(name);
        button.setAttribute("aria-pressed", String(!hidden.has(name)));
        for (const [element, figure] of charts) if (figure.hidden === hidden && element.on) draw(element);
      });
      return button;
    });
    for (const figure of figures) figure.hidden = hidden;
    place.replaceChildren(...(title ? [made("em", {}, title)] : []), ...buttons);
  };

  const plate = (figure, number) => {
    const { panels, title } = data.figures[figure.dataset.figure].plates[number];
    const grid = figure.querySelector(".panels");
    grid.querySelectorAll(".chart").forEach(drop);
    grid.style.setProperty("--least", panels.length === 3 || panels.length > 4 ? "360px" : "480px");
    grid.classList.toggle("one", panels.length === 1);
    grid.replaceChildren(...panels.map((panel) => {
      const chart = made("div", { class: "chart" });
      return made("div", { class: "panel" }, ...(panel.title ? [made("h4", {}, panel.title)] : []), chart);
    }));
    legend(figure.querySelector(".legend"), panels, title);
    grid.querySelectorAll(".chart").forEach((chart, n) => show(chart, panels[n]));
    figure.querySelectorAll(".file").forEach((each, n) => { each.hidden = n !== number; });
  };
  const figures = document.querySelectorAll("[data-figure]");
  figures.forEach((figure) => {
    const select = figure.querySelector("select");
    plate(figure, select?.selectedIndex ?? 0);
    select?.addEventListener("change", () => plate(figure, select.selectedIndex));
  });

  const redraw = () => charts.forEach((_, element) => { if (element.on) draw(element); });
  document.addEventListener("themed", redraw);
  let before = null;
  addEventListener("beforeprint", () => {
    charts.forEach((_, element) => { if (!element.on && !isFolded(element)) begin(element); });
    before = document.documentElement.dataset.theme;
    setTheme("light");
    charts.forEach((_, element) => {
      if (!element.on) return;
      const [width, height] = element.closest(".one") ? [620, 300] : [330, 230];  // of A4 or letter paper
      const smaller = { "font.size": 10, "xaxis.title.font.size": 10, "yaxis.title.font.size": 10 };
      Plotly.relayout(element, { width, height, autosize: false, ...smaller });
    });
  });
  addEventListener("afterprint", () => {
    setTheme(before);  // draws all again, without what was for paper
    charts.forEach((_, element) => { if (element.on) Plotly.Plots.resize(element); });
  });
  window.simmpp = { data, made, show, legend };
})();
