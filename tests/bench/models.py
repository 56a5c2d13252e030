"""What cooking many models comes to: models.py GTX [OPTION...] MODEL-OR-FOLDER...

Of each model: triangles, the partition and resolution that `gtx cook` took, patches, texels, bytes,
processor seconds of the cook, and of `gtx compare --levels 1` wall and hole pixels of how many, the
silhouettes' IoU, the forward RMS and processor seconds. Options are the cook's; `--size N` is the
comparison's, and `--cook-only` leaves it out. Models that are refused have the reason instead.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile

KINDS = ('.glb', '.gltf', '.obj', '.ply', '.off', '.obj.gz', '.ply.gz', '.off.gz', '.drc')


def models_of(paths):
    for path in paths:
        if not os.path.isdir(path):
            yield path
        for folder, folders, files in os.walk(path):
            folders.sort()
            yield from (os.path.join(folder, f) for f in sorted(files) if f.endswith(KINDS))


def run(*command):
    """The exit code, what it said, and its processor seconds."""
    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    before = spent()
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr, spent() - before


def measure(gtx, model, options, size, folder):
    asset, report = os.path.join(folder, 'asset.gtx'), os.path.join(folder, 'report.json')
    code, _, said, seconds = run(gtx, 'cook', model, '-q', '-o', asset, '--report', report, *options)
    if code:
        return said.strip().split('\n')[-1].split(': ', 1)[-1][:90]
    with open(report, encoding='utf-8') as file:
        cooked = json.load(file)
    line = [f"{cooked['source']['triangles']}", f"{cooked['partition']} {cooked['resolution']}",
            f"{cooked['charts']}", f"{cooked['texels_total'] / 1000:.0f}k",
            f"{os.path.getsize(asset) / 1000:.0f}k", f'{seconds:.2f} s']
    if size:
        code, out, said, seconds = run(gtx, 'compare', asset, model, '-q', '--json', '--levels', '1',
                                       '--size', size)
        if code:
            return ' | '.join(line + [said.strip().split('\n')[-1][-90:]])
        seen = json.loads(out)
        line += [f"{seen['wall_pixels']}", f"{seen['hole_pixels']} of {seen['surface_pixels']}",
                 f"{seen['silhouette_iou']:.4f}", f"{100 * seen['error']['forward']['rms']:.4f} %",
                 f'{seconds:.1f} s']
    return ' | '.join(line)


def main(gtx, *arguments):
    options, paths, size = [], [], '1024'
    arguments = list(arguments)
    while arguments:
        word = arguments.pop(0)
        if word == '--cook-only':
            size = None
        elif word == '--size':
            size = arguments.pop(0)
        elif word.startswith('--'):
            options += [word, arguments.pop(0)]
        else:
            paths.append(word)
    print('| model | triangles | partition | patches | texels | bytes | cook |'
          + (' walls | holes | IoU | RMS | compare |' if size else ''))
    print('|---|---|---|---|---|---|---|' + ('---|---|---|---|---|' if size else ''), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for model in models_of(paths):
            row = measure(gtx, model, options, size, folder)
            print(f'| {os.path.basename(model)} | {row} |', flush=True)


main(*sys.argv[1:])
