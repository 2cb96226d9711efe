const form = document.getElementById("time");
const slider = document.getElementById("slider");
const all = document.getElementById("all");
const shown = document.getElementById("shown");
const figures = [...document.querySelectorAll("#frames > figure")];

function show() {
  const at = Number(slider.value);
  figures.forEach((figure, n) => figure.classList.toggle("other", n !== at && !all.checked));
  shown.textContent = figures[at].dataset.title;
  slider.setAttribute("aria-valuetext", figures[at].dataset.title);
  if (all.checked) figures[at].scrollIntoView({ block: "nearest" });
}

slider.addEventListener("input", show);
all.addEventListener("change", show);
form.addEventListener("submit", (event) => event.preventDefault());
form.hidden = false;
show();
