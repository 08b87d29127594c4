// Labels the toggles of the list of pages for screen readers: the theme gives them no text.
document.addEventListener("DOMContentLoaded", () => {
  for (const toggle of document.querySelectorAll("summary:has(.toctree-toggle)")) {
    toggle.setAttribute("aria-label", "pages below this one");
  }
});
