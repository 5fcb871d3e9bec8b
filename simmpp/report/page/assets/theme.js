// Light or dark: as the system says, until the reader chooses. Runs before anything is painted.
(() => {
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const kept = () => { try { return localStorage.getItem("simmpp-theme"); } catch { return null; } };
  window.setTheme = (theme) => {
    root.dataset.theme = theme;
    const button = document.getElementById("theme");
    if (button) button.textContent = theme === "dark" ? "Light" : "Dark";
    document.dispatchEvent(new Event("themed"));
  };
  const follow = () => setTheme(kept() || (dark.matches ? "dark" : "light"));
  follow();
  dark.addEventListener("change", follow);
  document.addEventListener("DOMContentLoaded", () => {
    follow();
    document.getElementById("theme").addEventListener("click", () => {
      const theme = root.dataset.theme === "dark" ? "light" : "dark";
      try { localStorage.setItem("simmpp-theme", theme); } catch { /* a file may have no storage */ }
      setTheme(theme);
    });
  });
})();
