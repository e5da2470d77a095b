// SPDX-License-Identifier: MIT
// For the pages: what a WebGL context shows now, and Cesium's patience.
export function pixels(gl) {
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const data = new Uint8Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
  return { width, height, data };
}

// How much of the picture is not background (magenta), and its mean colour.
export function summary({ data }) {
  let covered = 0;
  const sum = [0, 0, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] > 200 && data[i + 1] < 60 && data[i + 2] > 200) continue;
    ++covered;
    for (let c = 0; c < 3; ++c) sum[c] += data[i + c];
  }
  return { covered: covered / (data.length / 4), color: sum.map((s) => Math.round(s / Math.max(1, covered))) };
}

// Until `at_rest` held for some frames on end, or a minute has passed.
export function rest(scene, at_rest) {
  return new Promise((done) => {
    let quiet = 0;
    const begin = performance.now();
    const stop = scene.postRender.addEventListener(() => {
      quiet = at_rest() ? quiet + 1 : 0;
      if (quiet > 8 || performance.now() - begin > 60000) { stop(); done(); }
    });
  });
}
