/* What checks draw, and how like two pictures are. */
import * as THREE from 'three';

/* A scene with such lights, and a picture of an object in it. */
export function stage({expect, read, WIDTH, HEIGHT}, ...lights) {
  const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
  renderer.setSize(WIDTH, HEIGHT, false);
  const scene = new THREE.Scene().add(...lights);
  const picture = (object, camera) => {
    scene.add(object);
    renderer.render(scene, camera);
    expect(renderer.getContext().getError() === 0, 'WebGL reports an error');
    scene.remove(object);
    return read(renderer.getContext());
  };
  return {renderer, scene, picture};
}

/* Intersection over union of what is not black, and the mean difference there. */
export function likeness(a, b) {
  const lit = (p, i) => p[i] + p[i + 1] + p[i + 2] > 0;
  let both = 0, either = 0, sum = 0;
  for (let i = 0; i < a.length; i += 4) {
    both += lit(a, i) && lit(b, i);
    either += lit(a, i) || lit(b, i);
    sum += [0, 1, 2].reduce((s, k) => s + Math.abs(a[i + k] - b[i + k]), 0) / 3;
  }
  return {overlap: both / either, off: sum / either};
}
