// While the sweep runs: look again every few seconds, but not while the reader looks elsewhere.
(() => {
  const key = "simmpp-scroll:" + location.pathname;
  try { scrollTo(0, Number(sessionStorage.getItem(key) || 0)); } catch { /* no storage */ }
  const again = () => {
    if (document.hidden || document.activeElement?.tagName === "SELECT") { setTimeout(again, 1000); return; }
    try { sessionStorage.setItem(key, String(scrollY)); } catch { /* no storage */ }
    location.reload();
  };
  setTimeout(again, 5000);
})();
