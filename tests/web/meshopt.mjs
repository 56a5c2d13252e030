/* node meshopt.mjs APP IN.drc OUT.obj: the triangles of a Draco file, for gltfpack, which reads none. */
import {createRequire} from 'node:module';
import {readFileSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';

const [, , app, from, to] = process.argv;
/* A module of the old kind in a package of the new one. */
const module = {exports: {}};
const code = resolve(app, 'node_modules/three/examples/jsm/libs/draco/draco_decoder.js');
new Function('module', 'exports', 'require', '__dirname', readFileSync(code, 'utf8'))(
    module, module.exports, createRequire(import.meta.url), '');
const draco = await module.exports();
const decoder = new draco.Decoder(), mesh = new draco.Mesh(), buffer = new draco.DecoderBuffer();
const bytes = readFileSync(from);
buffer.Init(new Int8Array(bytes), bytes.length);
const status = decoder.DecodeBufferToMesh(buffer, mesh);
if (!status.ok())
  throw new Error(`${from}: ${status.error_msg()}`);
const points = new draco.DracoFloat32Array(), corners = new draco.DracoInt32Array(), lines = [];
decoder.GetAttributeFloatForAllPoints(
    mesh, decoder.GetAttribute(mesh, decoder.GetAttributeId(mesh, draco.POSITION)), points);
for (let i = 0; i < 3 * mesh.num_points(); i += 3)
  lines.push(`v ${points.GetValue(i)} ${points.GetValue(i + 1)} ${points.GetValue(i + 2)}`);
for (let i = 0; i < mesh.num_faces(); ++i) {
  decoder.GetFaceFromMesh(mesh, i, corners);
  lines.push(`f ${[0, 1, 2].map((k) => corners.GetValue(k) + 1).join(' ')}`);
}
writeFileSync(to, lines.join('\n') + '\n');
