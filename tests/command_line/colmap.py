"""COLMAP's part of the test of databases. Prints JSON.

match MODEL PICTURES FOLDER NAME…     database of pictures, cameras.txt, five true clicks in the first and the last
register MODEL DATABASE FOLDER NAME…  reconstruction from a database
"""

import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pycolmap

pycolmap.logging.minloglevel = 3


def register(model, database, folder, names):
    """Runs the mapper, and compares the pose of the first and the last picture with that of the model."""
    options = pycolmap.IncrementalPipelineOptions()
    options.min_model_size = 2
    options.ba_refine_focal_length = False
    out = folder / "sparse"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    found = pycolmap.incremental_mapping(database, folder, out, options=options)
    images = {image.name: image for image in found[0].images.values() if image.has_pose}
    true = {image.name: image for image in model.images.values()}

    def turn(images):
        pose = images[names[-1]].cam_from_world() * images[names[0]].cam_from_world().inverse()
        return pose.rotation

    is_whole = names[-1] in images
    return {
        "registered": len(images),
        "residual": found[0].compute_mean_reprojection_error(),
        "rotation_error": float(np.degrees(turn(images).angle_to(turn(true)))) if is_whole else None,
    }


def match(model, pictures, folder, names):
    """Matches all pictures, and returns true matches of the first and the last one, far apart."""
    true = {image.name: image for image in model.images.values()}
    for name in names:
        shutil.copy(pictures / name, folder)
    database = folder / "database.db"
    reader = pycolmap.ImageReaderOptions(camera_model="PINHOLE")
    mode = pycolmap.CameraMode.PER_IMAGE
    pycolmap.extract_features(
        database, folder, image_names=names, camera_mode=mode, reader_options=reader, device=pycolmap.Device.cpu
    )
    with pycolmap.Database.open(database) as opened:
        for image in opened.read_all_images():
            camera = opened.read_camera(image.camera_id)
            camera.params = true[image.name].camera.params
            camera.has_prior_focal_length = True
            opened.update_camera(camera)
    cameras = [true[name].camera for name in (names[0], names[-1])]
    rows = [f"{k} PINHOLE {c.width} {c.height} {' '.join(map(repr, c.params.tolist()))}\n" for k, c in enumerate(cameras)]
    (folder / "cameras.txt").write_text("".join(rows))
    pycolmap.match_exhaustive(database, device=pycolmap.Device.cpu)
    with pycolmap.Database.open(database) as opened:
        verified = len(opened.read_two_view_geometry(*numbers(opened, names)).inlier_matches)
    names = [names[0], names[-1]]
    seen = [{p.point3D_id for p in true[name].points2D if p.has_point3D()} for name in names]
    points = [model.points3D[k].xyz for k in sorted(seen[0] & seen[1])]
    places = np.array([np.concatenate([true[name].project_point(x) for name in names]) for x in points])
    clicks = [0]
    while len(clicks) < 5:
        nearest = np.min([np.linalg.norm(places[:, :2] - places[k, :2], axis=1) for k in clicks], axis=0)
        clicks.append(int(np.argmax(nearest)))
    # COLMAP counts the centre of the top-left pixel as (0.5, 0.5).
    return {"verified": verified, "clicks": (places[clicks] - 0.5).tolist()}


def numbers(opened, names):
    """Returns the numbers of the first and the last picture."""
    return [opened.read_image_with_name(name).image_id for name in (names[0], names[-1])]


def read(database, names):
    """Returns what COLMAP reads of the pair."""
    with pycolmap.Database.open(database) as opened:
        pair = numbers(opened, names)
        geometry = opened.read_two_view_geometry(*pair)
        keypoints = [np.asarray(opened.read_keypoints(k)) for k in pair]
    p, q = (np.c_[keypoints[k][geometry.inlier_matches[:, k], :2], np.ones(len(geometry.inlier_matches))] for k in (0, 1))
    lines = p @ geometry.F.T
    distances = np.abs(np.sum(q * lines, axis=1)) / np.linalg.norm(lines[:, :2], axis=1)
    return {
        "config": int(geometry.config),
        "verified": len(geometry.inlier_matches),
        "distance": float(np.median(distances)),
        "pose": geometry.cam2_from_cam1 is not None,
    }


task, model, *rest = sys.argv[1:]
model = pycolmap.Reconstruction(model)
if task == "match":
    pictures, folder, *names = rest
    result = match(model, Path(pictures), Path(folder), names)
    database = Path(folder) / "database.db"
else:
    database, folder, *names = rest
    result = read(database, names)
print(json.dumps(result | register(model, Path(database), Path(folder), names)))
