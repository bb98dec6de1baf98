"""Matches of OpenCV's SIFT between two pictures, as JSON on standard output.

Usage: opencv.py MOST PICTURE PICTURE. RootSIFT, mutual nearest neighbours, no ratio test, without duplicates.
"""

import json
import sys

import cv2
import numpy


def features(path, most):
    picture = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    keypoints, descriptors = cv2.SIFT_create(nfeatures=most).detectAndCompute(picture, None)
    return cv2.KeyPoint_convert(keypoints), numpy.sqrt(descriptors / descriptors.sum(axis=1, keepdims=True))


points1, descriptors1 = features(sys.argv[2], int(sys.argv[1]))
points2, descriptors2 = features(sys.argv[3], int(sys.argv[1]))
similarity = descriptors1 @ descriptors2.T
nearest2, nearest1 = similarity.argmax(axis=1), similarity.argmax(axis=0)
first = numpy.arange(len(points1))
mutual = nearest1[nearest2] == first
matches = numpy.hstack([points1[first[mutual]], points2[nearest2[mutual]]])
json.dump(numpy.unique(matches, axis=0).tolist(), sys.stdout)
