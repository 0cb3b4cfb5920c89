// A panel in motion, drawn by WebGL 2 from arrays in the page (report/shot/moving.py has their layout).
async function view3d(root) {
  const head = JSON.parse(root.querySelector("script").textContent);
  const canvas = root.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl || !window.DecompressionStream) return root.classList.add("unavailable");
  const letters = atob(head.data), packed = new Uint8Array(letters.length);
  for (let k = 0; k < packed.length; k++) packed[k] = letters.charCodeAt(k);
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const buffer = await new Response(unpacked).arrayBuffer();
  const { nodes, elements, instants } = head, corners = [0, 1, 2, 0, 2, 3];
  let offset = 0;
  const take = (Kind, count) => {
    const values = new Kind(buffer, offset, count);
    offset += values.byteLength;
    return values;
  };
  const body = take(Float32Array, (head.rings ? instants * head.rings : head.bodyVertices) * 3);
  const { faceRows, faceColumns } = head;
  const face = take(Float32Array, instants * faceRows * faceColumns * 3); // of the block behind
  const quads = take(Uint32Array, elements * 4);
  const places = take(Uint16Array, instants * nodes * 3); // differences from the instant before
  const tensions = take(Uint8Array, instants * elements * 2);
  const failed = take(Uint8Array, instants * elements);
  const ply = take(Uint8Array, elements);
  for (let k = nodes * 3; k < places.length; k++) places[k] += places[k - nodes * 3];
  const coordinate = (k) => head.origin[k % 3] + head.step[k % 3] * places[k]; // [m]
  const fields = {
    tension: (instant, e) => Math.max(fields.warp(instant, e), fields.weft(instant, e)),
    warp: (instant, e) => tensions[(instant * elements + e) * 2] / head.perUnit,
    weft: (instant, e) => tensions[(instant * elements + e) * 2 + 1] / head.perUnit,
    deflection: (instant, e) => {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += coordinate((instant * nodes + quads[4 * e + k]) * 3 + 2) / 4;
      return sum - head.rest[ply[e]];
    },
  };

  const shader = (kind, text, made = gl.createShader(kind)) => {
    gl.shaderSource(made, text), gl.compileShader(made);
    return made;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `#version 300 es
    in vec3 place, colour; uniform mat3 turn; uniform vec3 side, shift, scale; out vec3 at, paint;
    void main() { at = turn * (place * side + shift); paint = colour; gl_Position = vec4(at * scale, 1.0); }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `#version 300 es
    precision highp float; in vec3 at, paint; out vec4 pixel;
    void main() {
      vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
      normal.y = abs(normal.y); // lit from above and below
      float light = 0.48 + 0.475 * max(dot(normal, vec3(0.62, 0.58, 0.53)), 0.0)
                         + 0.185 * max(dot(normal, vec3(-0.6, 0.1, 0.79)), 0.0);
      pixel = vec4(paint * light, 1.0);
    }`));
  gl.linkProgram(program), gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST), gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.clearColor(1, 1, 1, 1);
  const uniform = (name) => gl.getUniformLocation(program, name);
  const fill = (buffers, position, colour) => {
    for (const [target, values] of [[buffers.position, position], [buffers.colour, colour]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, target);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    }
  };
  const fabric = { position: gl.createBuffer(), colour: gl.createBuffer(), count: 0 };
  const steel = { position: gl.createBuffer(), colour: gl.createBuffer(), count: head.bodyVertices };
  if (!head.rings) fill(steel, body, Uint8Array.from({ length: body.length }, (_, k) => head.steel[k % 3]));
  const turned = new Float32Array(head.bodyVertices * 3), shade = new Uint8Array(head.bodyVertices * 3);
  const loadBody = (instant) => { // a projectile of metal: rings r, z and plastic strain, turned about its axis
    let vertices = 0;
    for (let ring = 0; ring < head.rings - 1; ring++)
      for (let sector = 0; sector < head.around; sector++)
        for (const [up, next] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) {
          const [r, z, plastic] = body.subarray((instant * head.rings + ring + up) * 3);
          const angle = (2 * Math.PI * (sector + next)) / head.around, part = Math.min(1, plastic / head.mostPlastic);
          turned.set([r * Math.cos(angle), r * Math.sin(angle), z], vertices);
          shade.set(head.steel.map((value, k) => value + part * (head.flowed[k] - value)), vertices);
          vertices += 3;
        }
    fill(steel, turned, shade);
  };
  const clay = { position: gl.createBuffer(), colour: gl.createBuffer(), count: 6 * Math.max(0, faceRows - 1) * Math.max(0, faceColumns - 1) };
  const clayPosition = new Float32Array(clay.count * 3);
  const clayColour = Uint8Array.from({ length: clay.count * 3 }, (_, k) => head.clay[k % 3]);
  const loadClay = (instant) => {
    let vertices = 0;
    for (let i = 0; i < faceRows - 1; i++)
      for (let j = 0; j < faceColumns - 1; j++)
        for (const corner of corners) {
          const [row, column] = [i + (corner === 1 || corner === 2), j + (corner > 1)];
          const node = ((instant * faceRows + row) * faceColumns + column) * 3;
          for (let axis = 0; axis < 3; axis++) clayPosition[vertices++] = face[node + axis];
        }
    fill(clay, clayPosition, clayColour);
  };
  const drawPart = (part, side, shift) => {
    for (const [name, target, type] of [["place", part.position, gl.FLOAT], ["colour", part.colour, gl.UNSIGNED_BYTE]]) {
      const place = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, target);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, type, type !== gl.FLOAT, 0, 0);
    }
    gl.polygonOffset(0, part === steel ? 4000 : 0); // behind fabric that it touches
    gl.uniform3fv(uniform("side"), side);
    gl.uniform3fv(uniform("shift"), shift);
    gl.drawArrays(gl.TRIANGLES, 0, part.count);
  };

  const slider = root.querySelector("input"), choice = root.querySelector("select");
  slider.max = slider.value = instants - 1;
  root.querySelector("i").style.background = `linear-gradient(to right, ${head.palette.map((c) => `rgb(${c})`)})`;
  const position = new Float32Array(elements * 18), colour = new Uint8Array(elements * 18);
  const load = () => {
    const instant = +slider.value, field = fields[choice.value], end = head.ends[choice.value];
    let vertices = 0;
    for (let e = 0; e < elements; e++) {
      const lost = failed[instant * elements + e];
      if (lost > 1) continue;
      const level = Math.max(0, Math.min(255, Math.round((255 * field(instant, e)) / end.value)));
      const paint = lost ? head.failed : head.palette[level];
      for (const corner of corners) {
        const node = (instant * nodes + quads[4 * e + corner]) * 3;
        for (let axis = 0; axis < 3; axis++) {
          position[vertices] = coordinate(node + axis);
          colour[vertices++] = paint[axis];
        }
      }
    }
    fabric.count = vertices / 3;
    loadClay(instant);
    fill(fabric, position.subarray(0, vertices), colour.subarray(0, vertices));
    if (head.rings) loadBody(instant);
    root.querySelector("output").textContent = head.captions[instant];
    root.querySelector(".high").textContent = end.text;
    draw();
  };

  const eye = { azimuth: 0.37, elevation: head.elevation, zoom: 1 };
  const draw = () => {
    const dense = window.devicePixelRatio || 1;
    [canvas.width, canvas.height] = [canvas.clientWidth * dense, canvas.clientHeight * dense];
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [ca, sa, ce, se] = [eye.azimuth, eye.elevation].flatMap((angle) => [Math.cos(angle), Math.sin(angle)]);
    gl.uniformMatrix3fv(uniform("turn"), false, [ca, -se * sa, ce * sa, sa, se * ca, -ce * ca, 0, ce, se]);
    const aspect = canvas.width / canvas.height, size = (1.5 * eye.zoom) / head.width;
    const scale = aspect > 1.6 ? size * 1.6 : size * aspect; // what is seen fits the narrower side
    gl.uniform3f(uniform("scale"), scale / aspect, scale, -0.3 / head.width);
    const nose = head.projectile[+slider.value], near = 1 - 1 / Math.max(1, eye.zoom);
    const centre = [-near * nose[0], -near * nose[1], (near - 1) * 0.5 * head.depth - near * nose[2]];
    for (const x of head.mirrors[0] ? [1, -1] : [1])
      for (const y of head.mirrors[1] ? [1, -1] : [1]) drawPart(fabric, [x, y, 1], centre);
    if (clay.count) drawPart(clay, [1, 1, 1], centre);
    drawPart(steel, [1, 1, 1], nose.map((value, axis) => value + centre[axis]));
  };

  const zoom = (factor) => turn(eye.azimuth, eye.elevation, Math.max(0.5, Math.min(40, eye.zoom * factor)));
  const turn = (azimuth, elevation, zoom = eye.zoom) => { Object.assign(eye, { azimuth, elevation, zoom }); draw(); };
  const buttons = { front: () => turn(0.37, -0.6), side: () => turn(0, 0), back: () => turn(0.37, 0.6),
                    nearer: () => zoom(1.4), farther: () => zoom(1 / 1.4) };
  let timer = 0;
  const stop = () => { timer = clearInterval(timer); root.querySelector(".play").textContent = "play"; };
  buttons.play = () => {
    if (timer) return stop();
    root.querySelector(".play").textContent = "pause";
    if (+slider.value === instants - 1) slider.value = 0;
    timer = setInterval(() => { slider.value = +slider.value + 1; load(); if (+slider.value === instants - 1) stop(); }, 100);
  };
  for (const [name, act] of Object.entries(buttons)) root.querySelector("." + name).onclick = act;
  slider.oninput = choice.onchange = load;
  canvas.onpointerdown = (event) => canvas.setPointerCapture(event.pointerId);
  canvas.onpointermove = (event) => {
    if (event.buttons) turn(eye.azimuth - event.movementX / 150, eye.elevation + event.movementY / 150);
  };
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return; // the page scrolls
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 300));
  }, { passive: false });
  window.addEventListener("resize", draw), load();
}
