// From disk no page may read another one: results of a search then come without an excerpt.
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;

// Films of the gallery play while they are seen, unless the reader has asked for less motion.
document.addEventListener("DOMContentLoaded", () => {
  if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  const seen = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) target.play().catch(() => {}); // refused where the browser saves power: the picture stays
      else target.pause();
    }
  }, { threshold: 0.5 });
  for (const film of document.querySelectorAll(".gallery video, .stage video")) seen.observe(film);
});
