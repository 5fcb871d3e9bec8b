// All points: a row for each, or only for those that a sentence or a figure is about.
(() => {
  const { data, made, measures, titled, enhance } = window.simmpp;
  if (!measures) return;
  const { points, rows, keys, values, titles, policies } = data.depth;
  const numbers = points.place.map((_, number) => number);
  const address = (number) => `#point=${encodeURIComponent(points.name[number])}`;

  // "2.14 (1.7 to 2.6)": intervals have a column of their own, what seeds have is told in depth.
  const parted = ([name, cell]) => {
    const [title, aside] = name.split(" (");
    const part = (number) => (n) => String(cell(n)).replace(")", "").split(" (")[number] ?? "–";
    return [[title, part(0)], ...(aside?.includes("interval") ? [[aside.replace(")", ""), part(1)]] : [])];
  };
  const columns = [
    ...Object.entries(values).map(([key, cells]) => [key, (n) => cells[points.place[n]]]),
    ["policy", (n) => policies[points.policy[n]]],
    ...measures.flatMap(parted),
  ];
  const link = Object.keys(values).length;  // the column that leads to the point in depth
  const line = (n) => {
    const cells = columns.map(([, cell]) => String(cell(n)));
    let row = null;
    const element = () => (row ??= made("tr", {}, ...cells.map((cell, column) => (column === link
      ? made("th", { scope: "row" }, made("a", { href: address(n), "aria-label": titled(n) }, cell))
      : made("td", column > link ? { class: "n" } : {}, cell)))));
    return { n, cells, element };
  };
  const ofPlace = (n) => [...Object.values(keys).map((cells) => cells[points.place[n]]), titles[points.policy[n]]];
  const said = (table, shared) => Object.keys(table).filter((name) => !shared.includes(name));
  const statistics = said(points, ["place", "name", "policy"]), results = said(rows, ["point"]);
  const files = {
    "CSV of points": (found) => [[...Object.keys(keys), "policy", ...statistics],
      ...found.map(({ n }) => [...ofPlace(n), ...statistics.map((name) => points[name][n])])],
    "CSV of their rows, seed by seed": (found) => {
      const wanted = new Set(found.map(({ n }) => n));
      return [[...Object.keys(keys), "policy", ...results],
        ...rows.point.flatMap((n, row) => (wanted.has(n) ? [[...ofPlace(n), ...results.map((name) => rows[name][row])]] : []))];
    },
  };
  const table = document.getElementById("all-points");
  table.replaceChildren(made("thead", {}, made("tr", {}, ...columns.map(([name], column) =>
    made("th", { scope: "col", class: column > link ? "n" : "" }, name)))), made("tbody"));
  const { show, only } = enhance(table, numbers.map(line), files);
  show();

  // What leads here: sentences, cells and figures with the numbers of the points that say so.
  const note = document.getElementById("only");
  const all = made("button", { type: "button" }, "All points");
  all.addEventListener("click", () => { only(null); note.hidden = true; });
  const leads = (source, text, of) => {
    const lead = made("a", { href: "#rows", class: "rows" }, ...text);
    lead.addEventListener("click", () => {
      const wanted = new Set(source());
      only(({ n }) => wanted.has(n));
      note.replaceChildren(`Only those of “${of}” `, all);
      note.hidden = false;
    });
    return lead;
  };
  for (const element of document.querySelectorAll("[data-points]")) {
    const of = element.dataset.points.split(" ").filter(Boolean).map(Number);
    const isCell = element.tagName === "TD", name = (element.closest("tr") ?? element).textContent.trim().replace(/\s+/g, " ");
    if (!of.length) continue;
    const text = isCell ? [...element.childNodes] : [of.length > 1 ? `${of.length} points` : "its rows"];
    const lead = of.length > 1 ? leads(() => of, text, name) : made("a", { href: address(of[0]), class: "rows" }, ...text);
    isCell ? element.replaceChildren(lead) : element.append(" ", lead);
  }
  for (const figure of document.querySelectorAll("[data-figure]")) {
    const shown = () => data.figures[figure.dataset.figure].plates[figure.querySelector("select")?.selectedIndex ?? 0].panels
      .flatMap((panel) => panel.data).flatMap((trace) => trace.customdata ?? []).filter((number) => number !== null);
    const place = figure.querySelector(".files") ?? figure.appendChild(made("p", { class: "files screen" }));
    if (shown().length) place.append(place.hasChildNodes() ? " · " : "", leads(shown, ["Its points as rows"], figure.querySelector("h3").textContent));
  }
})();
