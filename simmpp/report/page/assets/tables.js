// Tables: a click on a header sorts, a text filters, and what is shown becomes a CSV file.
(() => {
  const { made } = window.simmpp;
  const FEW = 8;  // rows that are seen at a glance: no filter
  const MOST = 500;  // rows that are put into the page at once
  const UNITS = { ps: 1e-12, ns: 1e-9, us: 1e-6, ms: 1e-3, s: 1, kB: 1e3, MB: 1e6, GB: 1e9, TB: 1e12 };
  const { compare } = new Intl.Collator("en", { numeric: true });

  // "12.5 us (9 us to 3 ms)" -> 12.5e-6: what a cell begins with; NaN of words.
  const amount = (text) => {
    const [, digits, unit] = /^([+-]?(?:\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?|inf))(?:\s*([a-zA-Z]+))?/.exec(text) ?? [];
    return digits ? Number(digits.replaceAll(",", "").replace("inf", "Infinity")) * (UNITS[unit] ?? 1) : NaN;
  };
  const isEmpty = (text) => text === "" || text === "–";
  // Without values last, whichever way the others are.
  const inOrder = (by, way) => (one, other) => {
    const [a, b] = [one.cells[by], other.cells[by]];
    if (isEmpty(a) || isEmpty(b)) return isEmpty(a) - isEmpty(b);
    const [low, high] = [amount(a), amount(b)];
    if (isNaN(low) !== isNaN(high)) return way * (isNaN(low) - isNaN(high));
    return way * (low < high ? -1 : low > high ? 1 : compare(a, b));
  };

  const quoted = (cell) => (/[",\n\r]/.test(cell) ? `"${String(cell).replaceAll('"', '""')}"` : String(cell ?? ""));
  const download = (name, rows) => {
    const text = rows.map((row) => row.map(quoted).join(",") + "\r\n").join("");
    const address = URL.createObjectURL(new Blob(["\ufeff", text], { type: "text/csv" }));  // the mark tells Excel it is UTF-8
    const stem = `${document.title} ${name}`.toLowerCase().replace(/[^a-z0-9.]+/g, "-").replace(/^-|-$/g, "");
    made("a", { href: address, download: `${stem}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  };

  // As programs read them: 1,234 is a number, not two.
  const plain = (text) => (/^-?\d{1,3}(,\d{3})+$/.test(text) ? text.replaceAll(",", "") : text);
  const textsOf = (row) => [...row.cells].map((cell) => cell.textContent.trim());
  const files = (region, labelled) => {
    const name = region.getAttribute("aria-label");
    const buttons = Object.entries(labelled).map(([label, rows]) => {
      const button = made("button", { type: "button", class: "link", "aria-label": `${label}: ${name}` }, label);
      button.addEventListener("click", () => download(`${name} ${label.replace("CSV", "")}`, rows()));
      return button;
    });
    region.after(made("p", { class: "files screen" }, "As a file: ", ...buttons.flatMap((button, n) => (n ? [", ", button] : [button]))));
  };

  // A line has its cells as texts, and the element that shows them, made when it is first needed;
  // a file its label, and rows made of the lines that are shown, the header first.
  const linesOf = (table) => [...table.tBodies[0].rows].map((row) => ({ cells: textsOf(row), element: () => row }));
  const enhance = (table, lines = linesOf(table), exported = null) => {
    const region = table.closest(".scroll"), heads = [...table.tHead.rows[0].cells], header = textsOf(table.tHead.rows[0]);
    exported ??= { CSV: (found) => [header, ...found.map((line) => line.cells.map(plain))] };
    let by = -1, way = 1, wanted = [], among = null;
    for (const line of lines) line.text = line.cells.join(" ").toLowerCase();
    const chosen = () => {
      const found = lines.filter((line) => (!among || among(line)) && wanted.every((word) => line.text.includes(word)));
      return by < 0 ? found : found.sort(inOrder(by, way));
    };
    const number = made("output", {});
    const show = () => {
      const found = chosen();
      table.tBodies[0].replaceChildren(...found.slice(0, MOST).map((line) => line.element()));
      const more = found.length > MOST ? `, the first ${MOST} shown` : "";
      number.textContent = found.length === lines.length && !more ? `${lines.length} rows` : `${found.length} of ${lines.length} rows${more}`;
    };
    // Up, down, and as it was.
    const sort = (column) => {
      [by, way] = by !== column ? [column, 1] : way > 0 ? [column, -1] : [-1, 1];
      heads.forEach((head, n) => (n === by ? head.setAttribute("aria-sort", way > 0 ? "ascending" : "descending") : head.removeAttribute("aria-sort")));
      show();
    };
    if (lines.length > 2) heads.forEach((head, column) => {
      if (!header[column]) return;
      const button = made("button", { type: "button", class: "sort" }, ...head.childNodes);
      button.addEventListener("click", () => sort(column));
      head.replaceChildren(button);
    });
    const filter = made("input", { type: "search", autocomplete: "off", placeholder: "part of a row" });
    filter.addEventListener("input", () => { wanted = filter.value.toLowerCase().split(/\s+/); show(); });
    if (lines.length > FEW) region.before(made("div", { class: "tools screen" }, made("label", {}, "filter ", filter), number));
    files(region, Object.fromEntries(Object.entries(exported).map(([label, rows]) => [label, () => rows(chosen())])));
    const only = (test) => { [among, wanted, filter.value] = [test, [], ""]; show(); };
    return { show, only };
  };
  document.querySelectorAll("table[data-table]").forEach((table) => enhance(table));
  // Those that are filled later are as they are when they are asked for.
  document.querySelectorAll("table[data-file]").forEach((table) => files(table.closest(".scroll"), { CSV: () => [...table.rows].map((row) => textsOf(row).map(plain)) }));
  window.simmpp.enhance = enhance;
})();
