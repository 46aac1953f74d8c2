"""The meshes that the viewer has, by model and detail: from a file beside this module, or built anew."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from .errors import ViewerError
from .mesh import Look, Mesh

FILE = Path(__file__).with_name("meshes.npz")
Meshes = Mapping[tuple[str, str], Mesh]


@cache
def model_mesh(kind: str, detail: str) -> Mesh:
    """One of `kinds.MODELS`, `full` or `simple`: of `FILE` where the add-on's zip put it, else built."""
    if FILE.is_file():
        return read_meshes(FILE)[kind, detail]
    # The add-on's zip has no builder: there the file is.
    from .models import build_model

    return build_model(kind, detail)


def write_meshes(path: Path, meshes: Meshes) -> None:
    """Writes all meshes to one compressed file; normals to a part in a hundred."""
    arrays: dict[str, np.ndarray] = {}
    described = []
    for number, ((kind, detail), mesh) in enumerate(meshes.items()):
        arrays[f"vertices{number}"] = mesh.vertices_m
        arrays[f"triangles{number}"] = mesh.triangles.astype(np.uint16)
        arrays[f"looks{number}"] = mesh.look_of.astype(np.uint8)
        if mesh.normals is not None:
            arrays[f"normals{number}"] = np.round(mesh.normals * 127.0).astype(np.int8)
        looks = [[look.name, look.rgb, look.roughness, look.metallic] for look in mesh.looks]
        described.append({"kind": kind, "detail": detail, "size": mesh.size_lwh_m, "looks": looks})
    arrays["described"] = np.frombuffer(json.dumps(described).encode(), dtype=np.uint8)
    np.savez_compressed(path, **arrays)


@lru_cache(maxsize=1)
def read_meshes(path: Path) -> Meshes:
    """Raises ViewerError for a file that `write_meshes` did not write."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            described = json.loads(arrays["described"].tobytes())
            return {
                (entry["kind"], entry["detail"]): _read_mesh(arrays, number, entry)
                for number, entry in enumerate(described)
            }
    except (OSError, ValueError, KeyError) as error:
        raise ViewerError(
            f"{path} is no mesh file of this viewer ({error}): install the add-on anew"
        ) from error


def _read_mesh(arrays: Mapping[str, np.ndarray], number: int, entry: dict) -> Mesh:
    name = f"normals{number}"
    normals = arrays[name].astype(np.float32) / 127.0 if name in arrays else None
    looks = tuple(
        Look(name, tuple(rgb), roughness, metallic) for name, rgb, roughness, metallic in entry["looks"]
    )
    return Mesh(
        arrays[f"vertices{number}"],
        arrays[f"triangles{number}"].astype(np.int32),
        arrays[f"looks{number}"].astype(np.int32),
        looks,
        tuple(entry["size"]),
        normals,
    )
