// Two panels in motion under one set of controls: the slider is time, what is turned in one is turned in both.
function together(pair) {
  const roots = [...pair.querySelectorAll(".view3d")], controls = pair.querySelector(".both");
  const times = roots.map((root) => JSON.parse(root.querySelector("script").textContent).times);
  const all = [...new Set(times.flat())].sort((a, b) => a - b);
  const slider = controls.querySelector("input"), choice = controls.querySelector("select");
  const show = () => {
    const now = all[+slider.value];
    roots.forEach((root, k) => {
      const own = root.querySelector("input");
      own.value = Math.max(0, times[k].filter((time) => time <= now).length - 1); // the last that is known
      root.querySelector("select").value = choice.value;
      own.oninput?.();
    });
    controls.querySelector("output").textContent = `${Math.round(1e6 * now)} µs after the strike`;
    controls.querySelector(".high").textContent = roots[0].querySelector(".high").textContent;
    controls.querySelector("i").style.background = roots[0].querySelector("i").style.background;
  };
  let timer = 0;
  const stop = () => { timer = clearInterval(timer); controls.querySelector(".play").textContent = "play"; };
  controls.querySelector(".play").onclick = () => {
    if (timer) return stop();
    controls.querySelector(".play").textContent = "pause";
    if (+slider.value === all.length - 1) slider.value = 0;
    timer = setInterval(() => { slider.value = +slider.value + 1; show(); if (+slider.value === all.length - 1) stop(); }, 100);
  };
  for (const name of ["front", "side", "back", "nearer", "farther"])
    controls.querySelector("." + name).onclick = () => roots.forEach((root) => root.querySelector("." + name).onclick());
  const canvases = roots.map((root) => root.querySelector("canvas"));
  canvases.forEach((canvas, k) => {
    const other = canvases[1 - k];
    canvas.addEventListener("pointermove", (event) => other.onpointermove?.(event));
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey || !event.isTrusted) return; // not one that this sent
      other.dispatchEvent(new WheelEvent("wheel", { deltaY: event.deltaY, ctrlKey: true, cancelable: true }));
    }, { passive: true });
  });
  slider.max = slider.value = all.length - 1;
  slider.oninput = choice.onchange = show;
  show();
}
for (const pair of document.querySelectorAll(".pair")) {
  const roots = [...pair.querySelectorAll(".view3d")];
  Promise.all(roots.map(view3d)).then(() => {
    if (roots.some((root) => root.classList.contains("unavailable"))) return pair.classList.add("unavailable");
    together(pair);
  });
}
