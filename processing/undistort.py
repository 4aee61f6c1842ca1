"""Taking a lens's distortion out of a picture."""

import cv2
import numpy as np

from litrig.base.camera_model import CameraModel
from litrig.base.errors import InputError
from processing.stack import F32, Correction


def undistortion(camera: CameraModel | None) -> Correction | None:
    """Return what straightens a picture (H, W, 3) of this camera, or None when there is nothing to straighten.

    The straightened picture keeps size, focal length and principal point.
    """
    if camera is None or not any(camera.distortion):
        return None
    # OpenCV calls the centre of the first pixel (0, 0).
    centre = camera.centre_x_px - 0.5, camera.centre_y_px - 0.5
    matrix = np.array([[camera.focal_x_px, 0, centre[0]], [0, camera.focal_y_px, centre[1]], [0, 0, 1]])
    size = (camera.width, camera.height)
    columns, rows = cv2.initUndistortRectifyMap(
        matrix, np.array(camera.distortion), np.eye(3), matrix, size, cv2.CV_32FC1
    )

    def straighten(picture: F32) -> F32:
        height, width = picture.shape[:2]
        if (width, height) != size:
            raise InputError(
                f"the camera model is for {size[0]} × {size[1]} pixels, the pictures have {width} × {height}; "
                "calibrate at the size of the capture"
            )
        straight = cv2.remap(picture, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(straight, np.float32)

    return straighten
