// Draws the scene of a page with Meshcat's viewer and moves its bones. No library but Meshcat, no network.
"use strict";
(function () {
  const THREE = MeshCat.THREE;
  const scene = JSON.parse(document.getElementById("scene").textContent);
  const byId = (id) => document.getElementById(id);
  const viewer = new MeshCat.Viewer(byId("pane"));

  function decoded(text, Kind) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    return new Kind(bytes.buffer);
  }

  // ------------------------------------------------------------------ stage: light, ground, camera
  viewer.set_property(["Background"], "top_color", [0.93, 0.95, 0.98]);
  viewer.set_property(["Background"], "bottom_color", [1, 1, 1]);
  viewer.set_property(["Axes"], "visible", false);
  for (const name of ["PointLightNegativeX", "PointLightPositiveX", "SpotLight", "FillLight"])
    viewer.set_property(["Lights", name], "visible", false);
  viewer.set_property(["Lights", "AmbientLight", "<object>"], "intensity", 0.75);
  for (const [name, at, strength] of [["Key", [-0.6, -1, 1.4], 0.5], ["Back", [1, 0.8, 0.5], 0.3]]) {
    const light = new THREE.DirectionalLight(0xffffff, strength);
    light.position.set(at[0], at[1], at[2]);
    viewer.set_object(["Lights", name], light);
  }
  const grid = new THREE.GridHelper(scene.grid.size, scene.grid.divisions, 0xaab2ba, 0xd3d8dd);
  grid.rotateX(Math.PI / 2);
  grid.position.set(scene.grid.centre[0], scene.grid.centre[1], scene.grid.centre[2]);
  viewer.set_object(["Grid"], grid);

  const [low, high] = scene.box;
  const radius = 0.5 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  const camera = new THREE.PerspectiveCamera(35, 1, radius / 100, radius * 100);
  viewer.set_camera(camera);
  viewer.set_object(["Cameras", "default", "rotated"], camera);
  // The camera's axes are those of the page: y up.
  const middle = low.map((value, i) => 0.5 * (value + high[i]));
  const away = [0.45, -1, 0.32], length = Math.hypot(...away);

  // As near as all corners of the box stay within this part of the window.
  const FILLED = 0.88;
  function look() {
    // The scene stands right of the panels and above the slider.
    const w = window.innerWidth, h = window.innerHeight;
    const side = w > 900 ? byId("legend").offsetWidth + 12 : 0, foot = 60;
    camera.aspect = w / h;
    camera.setViewOffset(w, h, -side / 2, foot / 2, w, h);
    viewer.controls.target.set(middle[0], middle[2], -middle[1]);
    const at = new THREE.Vector3();
    const seen = (distance) => {
      const eye = middle.map((value, i) => value + distance * away[i] / length);
      camera.position.set(eye[0], eye[2], -eye[1]);
      camera.lookAt(viewer.controls.target);
      camera.updateMatrixWorld();
      let most = 0;
      for (let i = 0; i < 8; i++) {
        at.set(scene.box[i & 1][0], scene.box[i >> 2][2], -scene.box[(i >> 1) & 1][1]).project(camera);
        most = Math.max(most, Math.abs(at.x - side / w) / (1 - side / w), Math.abs(at.y - foot / h) / (1 - foot / h));
      }
      return most;
    };
    let near = radius, far = 40 * radius;
    while (far / near > 1.01) { const half = Math.sqrt(near * far); if (seen(half) > FILLED) near = half; else far = half; }
    seen(far);
    viewer.controls.update();
    viewer.set_dirty();
  }

  // ------------------------------------------------------------------ skins on bones
  const skins = scene.skins.map(function (data) {
    const bone = decoded(data.bone, Int16Array), place = decoded(data.place, Float32Array);
    const weight = data.weight === null ? null : decoded(data.weight, Float32Array);
    const corners = data.corners, geometry = new THREE.BufferGeometry();
    const positions = new THREE.BufferAttribute(new Float32Array(3 * corners), 3);
    geometry.setAttribute("position", positions);
    geometry.setIndex(new THREE.BufferAttribute(decoded(data.faces, Uint32Array), 1));
    const clear = data.opacity < 1;
    let object;
    if (data.lines) {
      object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: data.colour }));
    } else {
      object = new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({
        color: data.colour, opacity: data.opacity, transparent: clear, depthWrite: !clear,
        flatShading: data.flat, side: THREE.DoubleSide, shininess: 40, specular: 0x222222 }));
    }
    object.frustumCulled = false;
    viewer.set_object(["arm", data.layer, data.name], object);
    const stiff = weight === null && bone.every((each) => each === bone[0]);
    const skin = { object, geometry, positions, bone, place, weight, corners, per: bone.length / corners, stiff };
    if (stiff) {
      positions.array.set(place);
      if (!data.lines) geometry.computeVertexNormals();
    }
    return skin;
  });

  const turn = new THREE.Quaternion(), other = new THREE.Quaternion(), shift = new THREE.Vector3();
  let bones = { x: new Float32Array(0), q: new Float32Array(0), n: 0 };

  function pose(bone) {
    if (bone < 0) {
      turn.set(0, 0, 0, 1);
      shift.set(0, 0, 0);
    } else {
      turn.fromArray(bones.q, 4 * bone);
      shift.fromArray(bones.x, 3 * bone);
    }
  }

  const corner = new THREE.Vector3();
  function place(skin) {
    if (skin.stiff) {
      pose(skin.bone[0]);
      skin.object.position.copy(shift);
      skin.object.quaternion.copy(turn);
      skin.object.visible = Number.isFinite(shift.x);
      return;
    }
    const to = skin.positions.array;
    to.fill(0);
    for (let v = 0, i = 0; v < skin.corners; v++) {
      for (let k = 0; k < skin.per; k++, i++) {
        pose(skin.bone[i]);
        corner.fromArray(skin.place, 3 * i).applyQuaternion(turn).add(shift);
        const w = skin.weight === null ? 1 : skin.weight[i];
        to[3 * v] += w * corner.x; to[3 * v + 1] += w * corner.y; to[3 * v + 2] += w * corner.z;
      }
    }
    skin.object.visible = Number.isFinite(to[0]) && Number.isFinite(to[to.length - 1]);
    skin.positions.needsUpdate = true;
    if (skin.object.isMesh) skin.geometry.computeVertexNormals();
  }

  // ------------------------------------------------------------------ labels
  const hidden = new Set();
  const labels = scene.labels.map(function (data) {
    const element = document.createElement("span");
    element.className = "label";
    element.textContent = data.text;
    element.style.color = (scene.layers.find((layer) => layer.name === data.layer) || {}).colour;
    byId("labels").appendChild(element);
    return { ...data, element };
  });

  // Labels of one place stand below one another, left of it where the window ends.
  function write() {
    const w = window.innerWidth, h = window.innerHeight, taken = [];
    viewer.scene.updateMatrixWorld();
    camera.updateMatrixWorld();
    for (const label of labels) {
      pose(label.bone);
      corner.fromArray(label.place).applyQuaternion(turn).add(shift);
      corner.set(corner.x, corner.z, -corner.y).project(camera);
      const shown = byId("show-labels").checked && !hidden.has(label.layer) && corner.z < 1;
      label.element.style.display = shown && Number.isFinite(corner.x) ? "" : "none";
      if (!shown) continue;
      const place = (0.5 + 0.5 * corner.x) * w, wide = label.element.offsetWidth;
      const x = place < w && place + 12 + wide > w ? place - 12 - wide : place + 12;
      let y = (0.5 - 0.5 * corner.y) * h - 9;
      while (taken.some((at) => Math.abs(at[0] - x) < 90 && Math.abs(at[1] - y) < 18)) y += 18;
      taken.push([x, y]);
      label.element.style.transform = `translate(${x}px, ${y}px)`;
    }
  }

  // ------------------------------------------------------------------ clips
  const clips = scene.clips.map((data) => ({
    ...data, time: decoded(data.time, Float64Array), x: decoded(data.x, Float32Array), q: decoded(data.q, Float32Array),
  }));
  let clip = clips[0], now = 0, playing = false;
  const end = () => clip.loops ? clip.time[clip.time.length - 1] + clip.time[1] - clip.time[0] : clip.time[clip.time.length - 1];

  function move(time) {
    const n = scene.bones, frames = clip.time;
    let i = 0, j = 0, share = 0;
    if (frames.length > 1) {
      let below = 0, above = frames.length;
      while (above - below > 1) { const half = (below + above) >> 1; if (frames[half] <= time) below = half; else above = half; }
      i = below;
      j = i + 1 < frames.length ? i + 1 : (clip.loops ? 0 : i);
      const step = i + 1 < frames.length ? frames[i + 1] - frames[i] : frames[1] - frames[0];
      share = j === i ? 0 : Math.min(1, Math.max(0, (time - frames[i]) / step));
    }
    if (bones.n !== n) bones = { x: new Float32Array(3 * n), q: new Float32Array(4 * n), n };
    for (let k = 0; k < 3 * n; k++) bones.x[k] = (1 - share) * clip.x[3 * n * i + k] + share * clip.x[3 * n * j + k];
    for (let k = 0; k < n; k++) {
      turn.fromArray(clip.q, 4 * (n * i + k)).slerp(other.fromArray(clip.q, 4 * (n * j + k)), share).toArray(bones.q, 4 * k);
    }
    skins.forEach(place);
    viewer.set_dirty();
  }

  function show(time) {
    now = Math.min(Math.max(time, clip.time[0]), end());
    byId("slider").value = now;
    byId("clock").textContent = `${now.toFixed(2)} / ${end().toFixed(2)} s`;
    move(now);
  }

  function play(wanted) {
    playing = wanted;
    byId("play").textContent = playing ? "Pause" : "Play";
  }

  function choose(index) {
    clip = clips[index];
    byId("text").textContent = clip.text;
    byId("text").style.display = clip.text ? "" : "none";
    [...byId("clips").children].forEach((button, i) => button.classList.toggle("on", i === index));
    document.body.classList.toggle("moving", clip.time.length > 1);
    byId("slider").min = clip.time[0];
    byId("slider").max = end();
    show(clip.time[0]);
  }

  if (clips.length > 1) clips.forEach(function (each, i) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = each.name;
    button.onclick = () => { choose(i); play(clips[i].time.length > 1); };
    byId("clips").appendChild(button);
  });

  // ------------------------------------------------------------------ legend
  function tick(text, colour, checked, changed, id) {
    const line = document.createElement("label"), tickbox = document.createElement("input");
    tickbox.type = "checkbox";
    tickbox.checked = checked;
    if (id) tickbox.id = id;
    tickbox.onchange = () => { changed(tickbox.checked); viewer.set_dirty(); };
    line.appendChild(tickbox);
    if (colour) {
      const swatch = document.createElement("i");
      swatch.style.background = colour;
      line.appendChild(swatch);
    }
    line.append(text);
    byId("legend").appendChild(line);
    changed(checked);
  }
  for (const layer of scene.layers) tick(layer.text, layer.colour, layer.shown, function (shown) {
    viewer.set_property(["arm", layer.name], "visible", shown);
    if (shown) hidden.delete(layer.name); else hidden.add(layer.name);
  });
  tick("names", null, true, () => {}, "show-labels");
  const ground = document.createElement("div");
  ground.className = "grid";
  ground.textContent = `grid: ${scene.grid.text}`;
  byId("legend").appendChild(ground);

  // ------------------------------------------------------------------ time
  byId("slider").oninput = (event) => { play(false); show(Number(event.target.value)); };
  byId("play").onclick = () => play(!playing);
  let last = null;
  function tock(stamp) {
    const passed = last === null ? 0 : (stamp - last) / 1000;
    last = stamp;
    if (playing && clip.time.length > 1) {
      const next = now + Math.min(passed, 0.25) * Number(byId("speed").value);
      show(next > end() ? clip.time[0] : next);
    }
    write();
    requestAnimationFrame(tock);
  }

  // "#clip=2&t=1.5" opens a page still at an instant, for pictures.
  const wanted = new URLSearchParams(location.hash.slice(1));
  choose(Math.min(Math.max(Number(wanted.get("clip") || 0), 0), clips.length - 1));
  if (wanted.has("t")) show(Number(wanted.get("t")));
  play(!wanted.has("t") && clip.time.length > 1);
  window.addEventListener("resize", look);
  look();
  requestAnimationFrame(() => { viewer.set_3d_pane_size(); look(); tock(performance.now()); });
  window.flexarm = { viewer, show, choose, play };
})();
