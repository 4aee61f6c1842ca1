"""An integrator for mitsuba that tells diffuse from reflected light at the first surface, with all that follows.

mitsuba has no such buffers. Rendering twice with one lobe of a material switched off is no way here: what its
neighbours mirror of it would change too. So lobes are told apart at the surface that the camera sees, and nowhere else.
"""

import functools
from typing import Any

from firmware_sim.mitsuba.variants import load_mitsuba

PLUGIN = "first_hit"
LAYERS = (
    *(f"{layer}.{channel}" for layer in ("diffuse", "reflection") for channel in "RGB"),
    "ambient_occlusion.Y",
    "reflection_occlusion.Y",
    *(f"normal.{axis}" for axis in "XYZ"),
)


@functools.cache
def load_first_hit(variant: str) -> Any:  # mitsuba's types differ from variant to variant
    """Return the module `mitsuba` with this variant set and the integrator `first_hit` registered.

    It lights by the environment alone. `max_depth` counts bounces, as that of `path` does; with `shadows` false nothing
    is in the way of the environment's light, and nothing else is there. Its layers are those of `LAYERS`: occlusion is
    the share of a lobe's rays that meet no part of their own object; normals have the material's bumps. It may be
    nested in `aov`.
    """
    mi = load_mitsuba(variant)
    import drjit as dr

    class FirstHit(mi.SamplingIntegrator):  # type: ignore[name-defined, misc]
        def __init__(self, properties: Any) -> None:
            super().__init__(properties)
            self.shadows = properties.get("shadows", True)
            # Without what the ray sees directly, which is counted here.
            follow = {"type": "path", "max_depth": properties.get("max_depth", 4) - 1, "hide_emitters": True}
            self.follow = mi.load_dict(follow)
            self.told = mi.load_dict({"type": "aov", "aovs": "told:sh_normal"})

        def aov_names(self) -> list[str]:
            return list(LAYERS)

        def sample(self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True) -> Any:
            del medium
            si = scene.ray_intersect(ray, active)
            hit = active & si.is_valid()
            diffuse, ambient = self.lobe(scene, sampler, si, hit, mi.BSDFFlags.Diffuse)
            reflection, reflected = self.lobe(scene, sampler, si, hit, mi.BSDFFlags.Glossy | mi.BSDFFlags.Delta)
            normal = self.normal(scene, sampler, ray, si, hit)
            layers = [*diffuse, *reflection, ambient, reflected, *normal]
            return diffuse + reflection, hit, layers

        def normal(self, scene: Any, sampler: Any, ray: Any, si: Any, hit: Any) -> Any:
            """Return the shading normal in the world's frame.

            mitsuba 3.9 tells that of a surface with bumps in the surface's own frame, and that of any other in the
            world's: it is then the one that the surface has anyway.
            """
            _, _, told = self.told.sample(scene, sampler, ray, None, hit)
            normal = mi.Vector3f(told[-3:])
            smooth = dr.dot(normal, si.sh_frame.n) > 1 - 1e-6
            return dr.select(hit, dr.select(smooth, normal, si.to_world(normal)), 0)

        def lobe(self, scene: Any, sampler: Any, si: Any, hit: Any, lobes: Any) -> tuple[Any, Any]:
            """Light that one kind of lobes sends to the eye, and whether the ray it chose met no part of its object."""
            context, bsdf = mi.BSDFContext(), si.bsdf()
            context.type_mask = lobes
            lamp, weight = scene.sample_emitter_direction(si, sampler.next_2d(hit), self.shadows, hit)
            value, density = bsdf.eval_pdf(context, si, si.to_local(lamp.d), hit)
            light = dr.select(hit & (lamp.pdf > 0), weight * value * balance(lamp.pdf, density), 0)

            chosen, weight = bsdf.sample(context, si, sampler.next_1d(hit), sampler.next_2d(hit), hit)
            good = hit & dr.any(weight > 0)
            ray = si.spawn_ray(si.to_world(chosen.wo))
            met = scene.ray_intersect(ray, good)
            own = met.is_valid() & (met.shape == si.shape)
            beyond = dr.zeros(mi.SurfaceInteraction3f)
            beyond.wi = -ray.d
            seen = dr.zeros(mi.DirectionSample3f)
            seen.d, seen.emitter = ray.d, scene.environment()
            free = good if not self.shadows else good & ~met.is_valid()
            sky = scene.environment().eval(beyond, free)
            other = scene.pdf_emitter_direction(si, seen, free)
            light += dr.select(free, weight * sky * balance(chosen.pdf, other), 0)
            if self.shadows:
                rest, _, _ = self.follow.sample(scene, sampler, mi.RayDifferential3f(ray), None, good)
                light += dr.select(good, weight * rest, 0)
            return light, dr.select(good & own & self.shadows, mi.Float(0), mi.Float(1))

    def balance(one: Any, other: Any) -> Any:
        """Share of one of two strategies with these densities (Veach's power heuristic)."""
        return dr.select(one > 0, one * one / (one * one + other * other), 0)

    mi.register_integrator(PLUGIN, FirstHit)
    return mi
