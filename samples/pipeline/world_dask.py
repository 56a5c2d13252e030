"""Cooks a planned world on a Dask cluster, whose workers see the world's folder and the command:

    pip install dask distributed
    gtx world plan MODEL... -o WORLD
    python world_dask.py WORLD [SCHEDULER:PORT]

Without a scheduler it starts two workers on this machine.
"""
import json
import os
import subprocess
import sys

import distributed


def after(others, world, limits, *names):
    """One process; what it needs is there, for Dask passes on the steps before it."""
    words = [os.environ.get("GTX", "gtx"), "world", names[0], world, *names[1:]]
    subprocess.run(words + ["-q", "--threads", "1", *limits], check=True)


def main(world, scheduler=None):
    with open(os.path.join(world, "plan.json")) as file:
        plan = json.load(file)
    tiles = plan["tiles"]
    limits = ["--max-memory", str(plan["memory"])]
    if plan["work"]:
        limits += ["--max-work", str(plan["work"])]

    def submit(needed, *names):
        return client.submit(after, needed, world, limits, *names, pure=False)

    cluster = scheduler or distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None)
    with distributed.Client(cluster) as client:
        split = submit([], "split")
        done = {t["name"]: submit([split], "cook", t["name"]) for t in tiles if t["leaf"]}
        for depth in range(max(t["depth"] for t in tiles), -1, -1):
            below = list(done.values())  # a tile's ring lies in its neighbours' low surfaces
            for tile in tiles:
                if tile["depth"] != depth or tile["leaf"]:
                    continue
                merged = submit(below, "merge", tile["name"])
                done[tile["name"]] = submit([merged], "cook", tile["name"])
        submit(list(done.values()), "index").result()


if __name__ == "__main__":
    main(*sys.argv[1:])
