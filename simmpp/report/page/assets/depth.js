// One point in depth: its place, all policies there, its accounts, messages and rows.
(() => {
  const { data, made, show, legend } = window.simmpp;
  const depth = data.depth;
  if (!depth.places.length) return;
  const { points, rows } = depth;
  const find = (id) => document.getElementById(id);
  const atPlace = depth.places.map(() => []);
  points.place.forEach((place, number) => atPlace[place].push(number));
  atPlace.forEach((numbers) => numbers.sort((a, b) => points.policy[a] - points.policy[b]));
  const rowsOf = points.place.map(() => []);
  rows.point.forEach((number, row) => rowsOf[number].push(row));

  const grouped = (cell) => (cell === "" || cell === undefined ? "–" : /^-?\d+$/.test(String(cell)) ? BigInt(cell).toLocaleString("en-US") : cell);
  const short = (value, digits = 4) => (typeof value === "number" ? String(Number(value.toPrecision(digits))) : value === "" ? "–" : value);
  const scaled = (value, units) => {
    const [unit, size] = units.find(([, each]) => Math.abs(value) >= each) || units.at(-1);
    return `${short(value / size)} ${unit}`;
  };
  const TIMES = [["s", 1e12], ["ms", 1e9], ["us", 1e6], ["ns", 1e3], ["ps", 1]];
  const SIZES = [["TB", 1e12], ["GB", 1e9], ["MB", 1e6], ["kB", 1e3], ["B", 1]];
  const known = (number, column) => rowsOf[number].map((row) => rows[column][row]).filter((cell) => cell !== "").map(Number);
  const mean = (number, column) => {
    const found = known(number, column);
    return found.length ? found.reduce((sum, each) => sum + each, 0) / found.length : null;
  };
  const range = (number, column, format) => {
    const found = known(number, column);
    if (!found.length) return "–";
    const low = format(Math.min(...found)), high = format(Math.max(...found));
    return low === high ? low : `${format(mean(number, column))} (${low} to ${high})`;
  };
  const profit = (number, measure) => {
    const [value, low, high] = depth.spreads[measure][number];
    return low === "" || short(low) === short(high) ? short(value) : `${short(value)} (${short(low)} to ${short(high)})`;
  };
  const count = (value) => Math.round(value).toLocaleString("en-US");
  const MEASURES = [
    ["time profit (95 % interval)", (n) => profit(n, "time_profit")],
    ["message profit (95 % interval)", (n) => profit(n, "message_profit")],
    ["speed-up", (n) => short(points.speedup[n])],
    ["efficiency", (n) => short(points.efficiency[n])],
    ["makespan (of the seeds)", (n) => range(n, "makespan_ps", (v) => scaled(v, TIMES))],
    ["messages", (n) => range(n, "messages", count)],
    ["bytes sent", (n) => range(n, "bytes_sent", (v) => scaled(v, SIZES))],
    ["rays sent", (n) => range(n, "rays_sent", count)],
    ["objects fetched", (n) => range(n, "objects_fetched", count)],
    ["most rays on a PE", (n) => range(n, "peak_rays", count)],
    ["most bytes on a PE", (n) => range(n, "peak_bytes", (v) => scaled(v, SIZES))],
    ["seeds", (n) => short(points.n[n])],
  ];

  const comparison = (numbers, chosen) => {
    const head = made("tr", {}, made("td"), ...numbers.map((n) => made("th", { class: n === chosen ? "n chosen" : "n", scope: "col" }, depth.policies[points.policy[n]])));
    const lines = MEASURES.map(([name, cell]) => made("tr", {}, made("th", { scope: "row" }, name),
      ...numbers.map((n) => made("td", { class: n === chosen ? "n chosen" : "n" }, cell(n)))));
    find("point-policies").replaceChildren(made("thead", {}, head), made("tbody", {}, ...lines));
    window.simmpp.explain?.(find("point-policies"));
  };
  const ownRows = (number) => {
    const columns = Object.keys(rows).filter((name) => name !== "point");
    const lines = columns.map((name) => made("tr", {}, made("th", { scope: "row" }, name),
      ...rowsOf[number].map((row) => made("td", { class: "n" }, grouped(rows[name][row])))));
    find("point-rows").replaceChildren(made("tbody", {}, ...lines));
  };
  const stacked = (id, numbers, parts, alt, unit = "") => {
    const names = numbers.map((n) => depth.policies[points.policy[n]]);
    const escaped = names.map((name) => name.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;"));
    const traces = Object.entries(parts).map(([part, values]) => ({
      type: "bar", orientation: "h", name: part, legendgroup: part, x: values, y: numbers.map((_, place) => place), customdata: numbers,
      text: values.map((value, place) => `<b>${part}</b><br>${escaped[place]}: ${short(value)}${unit}`),
      marker: { color: `var(--p${depth.colours[part]})`, line: { width: 0 } },
    }));
    const layout = { barmode: "stack", bargap: 0.3, showlegend: false, hovermode: "closest", margin: { l: 10 },
      xaxis: { rangemode: "tozero", automargin: true }, yaxis: { tickvals: numbers.map((_, place) => place), ticktext: escaped, autorange: "reversed", automargin: true } };
    const said = names.map((name, place) => `${name}: ${Object.entries(parts).map(([part, values]) => `${part} ${short(values[place], 3)}`).join(", ")}`);
    const figure = { data: traces, layout, alt: `${alt}. ${said.join("; ")}` };
    legend(find(`${id}-legend`), [figure]);
    show(find(id), figure);
  };
  const shares = (numbers) => {
    const sums = numbers.map((n) => {
      const each = Object.values(depth.accounts).map((column) => mean(n, column));
      return each.includes(null) ? each.map(() => 0) : each;  // a model knows no more than the computing
    });
    const whole = sums.map((each) => each.reduce((sum, value) => sum + value, 0) || 1);
    return Object.fromEntries(Object.keys(depth.accounts).map((part, k) => [part, sums.map((each, n) => (100 * each[k]) / whole[n])]));
  };
  const kinds = (numbers) => Object.fromEntries(Object.entries(depth.kinds).map(([part, column]) => [part, numbers.map((n) => mean(n, column) || 0)]));

  const titled = (number) => `${depth.places[points.place[number]]}: ${depth.policies[points.policy[number]]}`;
  const place = find("place"), policy = find("policy");
  let current = null;
  // The address names the point by its keys: numbers change while a sweep grows.
  const remember = () => history.replaceState(null, "", `#point=${encodeURIComponent(points.name[current])}`);
  const choose = (number, isClicked) => {
    current = number;
    const at = points.place[number], numbers = atPlace[at];
    place.selectedIndex = at;
    policy.replaceChildren(...numbers.map((n) => made("option", { value: n }, depth.policies[points.policy[n]])));
    policy.value = String(number);
    find("point-title").textContent = titled(number);
    find("point-limits").textContent = depth.limits[number];
    comparison(numbers, number);
    stacked("point-accounts", numbers, shares(numbers), "Shares of the time of all PEs", " %");
    stacked("point-messages", numbers, kinds(numbers), "Messages by kind");
    ownRows(number);
    if (!isClicked) return;
    remember();
    find("point").scrollIntoView();
  };
  place.replaceChildren(...depth.places.map((name) => made("option", {}, name)));
  place.addEventListener("change", () => {
    const numbers = atPlace[place.selectedIndex], same = numbers.find((n) => points.policy[n] === points.policy[current]);
    choose(same ?? numbers[0]);
    remember();
  });
  policy.addEventListener("change", () => {
    choose(Number(policy.value));
    remember();
  });
  document.addEventListener("chosen", (event) => choose(event.detail, true));
  const named = () => (location.hash.startsWith("#point=") ? points.name.indexOf(decodeURIComponent(location.hash.slice(7))) : -1);
  addEventListener("hashchange", () => { if (named() >= 0) choose(named(), true); });
  const asked = named();
  choose(asked < 0 ? data.first : asked);
  if (asked >= 0 && !data.live) find("point").scrollIntoView();
  Object.assign(window.simmpp, { measures: MEASURES, titled });
})();
