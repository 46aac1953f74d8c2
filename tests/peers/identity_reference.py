#!/usr/bin/env python3
"""Scores identities with `trackeval`, the reference implementation of HOTA.

usage: identity_reference.py < MOMENTS

Reads a JSON list of {"truths": [ids], "found": [ids], "similarity": [[...]]} and prints one JSON object with idf1, hota,
deta, assa, mota, switches, fragmentations.
"""

import json
import sys

import numpy as np
from trackeval.metrics import CLEAR, HOTA, Identity


def numbers(ids):
    """Numbers from 0, in order of appearance."""
    return {one: number for number, one in enumerate(dict.fromkeys(ids))}


def main():
    moments = json.load(sys.stdin)
    truths = numbers(one for moment in moments for one in moment["truths"])
    found = numbers(one for moment in moments for one in moment["found"])
    data = {
        "num_timesteps": len(moments),
        "num_gt_ids": len(truths),
        "num_tracker_ids": len(found),
        "num_gt_dets": sum(len(moment["truths"]) for moment in moments),
        "num_tracker_dets": sum(len(moment["found"]) for moment in moments),
        "gt_ids": [np.array([truths[one] for one in m["truths"]], dtype=int) for m in moments],
        "tracker_ids": [np.array([found[one] for one in m["found"]], dtype=int) for m in moments],
        "similarity_scores": [
            np.array(m["similarity"], dtype=float).reshape(len(m["truths"]), len(m["found"]))
            for m in moments
        ],
    }
    quiet = {"PRINT_CONFIG": False}
    hota = HOTA().eval_sequence(data)
    clear = CLEAR(quiet).eval_sequence(data)
    identity = Identity(quiet).eval_sequence(data)
    print(
        json.dumps(
            {
                "idf1": float(identity["IDF1"]),
                "hota": float(np.mean(hota["HOTA"])),
                "deta": float(np.mean(hota["DetA"])),
                "assa": float(np.mean(hota["AssA"])),
                "mota": float(clear["MOTA"]),
                "switches": int(clear["IDSW"]),
                "fragmentations": int(clear["Frag"]),
            }
        )
    )


if __name__ == "__main__":
    main()
