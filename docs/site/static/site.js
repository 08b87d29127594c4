// Names what folds the list of pages, which the theme leaves without a word for those who hear the page.
document.addEventListener("DOMContentLoaded", () => {
  for (const fold of document.querySelectorAll("summary:has(.toctree-toggle)")) {
    fold.setAttribute("aria-label", "pages below this one");
  }
});
