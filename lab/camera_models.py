"""Prints reference values of camera models for src/camera/reference.txt.

Each row: the model, its parameters, a ray x y z, its pixel by pycolmap (centre of the top-left pixel at (0.5, 0.5));
rows `opencv` have distortion coefficients and a pixel by OpenCV (centre at (0, 0)).
Needs pycolmap and OpenCV.
"""

import itertools

import cv2
import numpy as np
import pycolmap

MODELS = {
    "SIMPLE_PINHOLE": [700, 320, 240],
    "PINHOLE": [700, 710, 321.5, 239],
    "SIMPLE_RADIAL": [690, 320, 240, -0.127],
    "RADIAL": [690, 322, 238, -0.3, 0.08],
    "OPENCV": [690, 695, 322, 238, -0.28, 0.07, 2e-4, -1e-3],
    "FULL_OPENCV": [690, 695, 322, 238, -0.28, 0.07, 2e-4, -1e-3, 0.01, 0.02, -0.003, 0.001],
    "SIMPLE_FISHEYE": [300, 320, 240],
    "FISHEYE": [300, 305, 320, 240],
    "SIMPLE_RADIAL_FISHEYE": [300, 320, 240, 0.02],
    "RADIAL_FISHEYE": [300, 321, 239, 0.02, -0.004],
    "OPENCV_FISHEYE": [282, 281, 316, 240, -0.0033, 0.054, -0.0516, 0.0107],
    "THIN_PRISM_FISHEYE": [300, 305, 320, 240, 0.01, -0.005, 1e-3, -2e-3, 0.002, -0.0005, 1e-3, -2e-3],
    "FOV": [400, 402, 320, 240, 0.9],
    "SIMPLE_DIVISION": [500, 320, 240, -0.2],
    "DIVISION": [500, 505, 320, 240, 0.1],
}


def row(*parts):
    print(" | ".join(" ".join(f"{v:.17g}" if not isinstance(v, str) else v for v in part) for part in parts))


for name, parameters in MODELS.items():
    camera = pycolmap.Camera(model=name, width=640, height=480, params=parameters)
    for u, v in itertools.product([12.0, 200.25, 320.0, 630.5], [8.5, 240.0, 401.0]):
        ray = camera.cam_from_img(np.array([[u, v]]))
        ray = np.ravel(ray)
        if ray.size == 2:
            ray = np.append(ray, 1.0)
        if not np.all(np.isfinite(ray)):
            continue
        pixel = np.ravel(camera.img_from_cam(ray[None, :]))
        row([name], parameters, ray, pixel)

K = np.array([[690.0, 0, 322], [0, 695, 238], [0, 0, 1]])
for count in [4, 5, 8, 12]:
    D = np.array([-0.28, 0.07, 2e-4, -1e-3, 0.01, 0.02, -0.003, 0.001, 1e-3, -5e-4, -2e-3, 3e-4][:count])
    for x, y in itertools.product([-0.45, 0.0, 0.2], [-0.3, 0.1]):
        pixel, derivatives = cv2.projectPoints(np.array([[[x, y, 1.0]]]), np.zeros(3), np.zeros(3), K, D)
        # Derivatives by the translation are those by the ray.
        row(["opencv"], D, [x, y, 1.0], np.ravel(pixel), np.ravel(derivatives[:, 3:6]))
D = np.array([-0.0033, 0.054, -0.0516, 0.0107])
for x, y in itertools.product([-1.5, 0.0, 0.6], [-0.8, 0.1]):
    pixel, derivatives = cv2.fisheye.projectPoints(np.array([[[x, y, 1.0]]]), np.zeros(3), np.zeros(3), K, D)
    row(["fisheye"], D, [x, y, 1.0], np.ravel(pixel), np.ravel(derivatives[:, 11:14]))
