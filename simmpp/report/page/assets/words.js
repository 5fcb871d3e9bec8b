// Words of the glossary: the first of each section is marked, and explained on hover, focus and tap.
(() => {
  const { made } = window.simmpp;
  const terms = [...document.querySelectorAll("#words dt")];
  const pattern = new RegExp(`(?<![\\w-])(?:${terms.map((term) => `(${term.dataset.forms})`).join("|")})(?![\\w-])`, "gi");
  const LEFT_OUT = "a, button, code, label, summary, svg, h2, h3, h4, .chart, .tall tbody, #words";
  const told = (term) => ({ "aria-describedby": term.nextElementSibling.id });

  const mark = (text, seen) => {
    pattern.lastIndex = 0;
    for (let match; (match = pattern.exec(text.data)); ) {
      const term = terms[match.slice(1).findIndex((form) => form !== undefined)];
      if (seen.has(term)) continue;
      seen.add(term);
      const word = text.splitText(match.index);
      text = word.splitText(match[0].length);
      word.replaceWith(made("a", { class: "term", href: `#${term.id}`, ...told(term) }, match[0]));
      pattern.lastIndex = 0;
    }
  };
  const explain = (place) => {
    const seen = new Set(), texts = [], walker = document.createTreeWalker(place, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) if (walker.currentNode.data.trim() && !walker.currentNode.parentElement.closest(LEFT_OUT)) texts.push(walker.currentNode);
    for (const text of texts) mark(text, seen);
    for (const button of place.querySelectorAll(".sort")) {
      pattern.lastIndex = 0;
      const match = pattern.exec(button.textContent);
      if (match) Object.entries({ class: "sort term", ...told(terms[match.slice(1).findIndex((form) => form !== undefined)]) }).forEach((pair) => button.setAttribute(...pair));
    }
  };

  const tip = document.body.appendChild(made("div", { id: "tip", hidden: "" }));
  let shown = null;
  const hide = () => { tip.hidden = true; shown = null; };
  const show = (element) => {
    if (element === shown) return;
    shown = element;
    const said = document.getElementById(element.getAttribute("aria-describedby"));
    tip.replaceChildren(made("strong", {}, said.previousElementSibling.textContent), `: ${said.textContent}`);
    tip.hidden = false;
    const box = element.getClientRects()[0], root = document.documentElement;
    const below = box.bottom + 6, isBelow = below + tip.offsetHeight < root.clientHeight;
    tip.style.left = `${Math.max(8, Math.min(box.left, root.clientWidth - tip.offsetWidth - 8)) + scrollX}px`;
    tip.style.top = `${(isBelow ? below : box.top - tip.offsetHeight - 6) + scrollY}px`;
  };
  const follow = ({ target }) => {
    const term = target.closest?.(".term");
    if (term) show(term);
    else if (shown && !tip.contains(target) && shown !== document.activeElement) hide();
  };
  document.addEventListener("pointerover", follow);
  document.addEventListener("focusin", follow);
  document.addEventListener("focusout", hide);
  tip.addEventListener("click", hide);  // it may lie over the next word
  document.addEventListener("keydown", ({ key }) => { if (key === "Escape") hide(); });
  // Where nothing hovers, a tap explains; elsewhere a click leads to all words.
  document.addEventListener("click", (event) => {
    const term = event.target.closest("a.term");
    if (!term) return;
    if (matchMedia("(hover: none)").matches) event.preventDefault();
    else hide();
  });
  const sections = [...document.querySelectorAll("main > section:not(#words)")];
  const page = sections.map((section) => section.textContent).join(" ");
  for (const term of terms) term.hidden = term.nextElementSibling.hidden = !new RegExp(`\\b${term.dataset.forms}`, "i").test(page);
  sections.forEach(explain);
  window.simmpp.explain = explain;
})();
