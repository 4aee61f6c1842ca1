"""Cables of a turntable that are pulled in a session, and plugged in again under another name."""

from firmware_sim.server import LINKS_NAME
from tests.faults.cameras import Watched, asked, folders
from tests.faults.outcome import Outcome, Scale
from tests.faults.real_sessions import quick_sim
from tests.faults.step_plans import arc


def fault_17_unplugged_in_a_session(campaign: Scale) -> Outcome:
    """Pull the servo's adapter in a session, plug it in under another name: on hold, then gone on with (row 18)."""
    wrong = again = 0
    with quick_sim("amc", camera={}) as sim, folders() as names:
        # Named as udev does, by what does not change when it is plugged in again; or as the port was called then.
        link = str(sim.rig_toml.parent / LINKS_NAME / "turntable")
        for trial in range(campaign.trials):
            changes = {"turntable": {"port": link}}
            if trial % 2:
                changes = {"turntable": {"port": sim.side_channel.status()["wires"]["turntable"]["port"]}}
            place = trial % 8
            at = {place: asked("turntable.unplug")} if place else {1: asked("turntable.unplug")}
            session = Watched(sim, arc(8), next(names), at, changes).run()
            port = sim.side_channel.request("turntable.replug")["port"]
            held = session.hold and len(session.good) >= max(place, 1)
            before = session.good
            if trial % 2:
                changes = {"turntable": {"port": port}}
            rest = Watched(sim, arc(8), session.folder, changes=changes).run(again=True)
            kept = [entry for entry in rest.good if entry in before] == before
            frames = [entry for entry in rest.entries if entry["ev"] == "frame"]
            again += len(frames) - 8
            wrong += not (held and kept and rest.is_whole() and len(frames) == 8)
    detail = f"on hold, nothing lost, {again} frames twice; resumed on the new port to a verified bag"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)
