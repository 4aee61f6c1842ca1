"""What every command that reads shading buffers can be told of them."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import PATH

if TYPE_CHECKING:
    from processing.shape.buffers_exr import ReadOptions


def buffers_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add options on layers and camera, handed over as `read_options`, which makes them when it is called."""

    @click.option(
        "--layer",
        "layers",
        metavar="BUFFER=LAYER",
        multiple=True,
        help="Take a buffer from this layer, a sum of layers, or a sum times one (diffuse='a + b * c'). Can be given "
        "again.",
    )
    @click.option(
        "--world-to-camera",
        metavar="FILE",
        type=PATH,
        help="Text file of 16 numbers that turn the world's positions and normals into the camera's, if the EXR does "
        "not say so itself.",
    )
    @click.option("--fov", "fov_deg", metavar="DEG", type=float, help="Field of view, left to right, to go with depth.")
    @click.option("--orthographic", is_flag=True, help="The picture is seen along one direction.")
    @click.option("--depth-along-ray", is_flag=True, help="Depth is the distance from the camera, not along its axis.")
    @wraps(command)
    def told(
        *args: Any,
        layers: tuple[str, ...],
        world_to_camera: Path | None,
        fov_deg: float | None,
        orthographic: bool,
        depth_along_ray: bool,
        **options: Any,
    ) -> Any:
        def read_options() -> "ReadOptions":
            from processing.shape.buffers.camera import CameraSaid
            from processing.shape.buffers_exr import ReadOptions, parse_layers

            camera = CameraSaid(world_to_camera, fov_deg, orthographic, depth_along_ray)
            return ReadOptions(parse_layers(layers), camera)

        return command(*args, read_options=read_options, **options)

    return told


def say(remark: str) -> None:
    """Print a remark where it does not mix with results."""
    click.echo(f"note: {remark}", err=True)
