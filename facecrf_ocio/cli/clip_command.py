"""`facecrf clip`: a sequence or video in, the LUTs of its one curve out."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.choices import Choices
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import (
    TEXT_PATH,
    compression_option,
    direction_options,
    estimation_options,
    require_exrs,
)
from facecrf_ocio.cli.output_files import folder_option, formats_option
from facecrf_ocio.cli.terminal import (
    UNREADABLE,
    USAGE,
    complain,
    ending_well,
    require_writable,
    say,
)
from facecrf_ocio.cli.told_estimates import tell
from facecrf_ocio.errors import LutError
from facecrf_ocio.files.plain_text import counted

if TYPE_CHECKING:
    from facecrf_ocio.clip.clip_estimate import ClipEstimate
    from facecrf_ocio.clip.drift_evidence import Drift
    from facecrf_ocio.clip.frame_list import Clip
    from facecrf_ocio.values import Estimate


@click.command()
@click.argument("source", type=TEXT_PATH, metavar="CLIP")
@folder_option
@formats_option
@direction_options
@click.option(
    "--frames",
    type=click.IntRange(1, 100),
    metavar="N",
    default=12,
    show_default=True,
    help="How many frames to use; three times as many are looked at.",
)
@click.option("--exr", is_flag=True, help="Also write every frame as a scene-linear EXR.")
@compression_option
@estimation_options
@ending_well
def clip(
    source: Path,
    output: Path,
    formats: tuple[str, ...],
    direction: str,
    space: str | None,
    frames: int,
    exr: bool,
    compression: str,
    **choices: Any,
) -> int:
    """Estimate the one curve of CLIP: frame.%04d.jpg, frame.####.png, a folder or a video file.

    Frames are chosen over time where a face is large and sharp. PQ, HLG and linear that a stream
    names are used and not estimated. A run with --exr that was broken off goes on when repeated.
    """
    from facecrf_ocio.clip.calibrate_clip import calibrate_clip
    from facecrf_ocio.clip.clip_source import open_clip
    from facecrf_ocio.lut.write import endings
    from facecrf_ocio.record.demand import Demand, demand
    from facecrf_ocio.record.outputs import write_outputs

    require_exrs(compression, asked=exr)
    chosen = Choices(**choices)
    try:
        formats = endings(formats, direction, space or "")
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    with status(f"calibrating {source}"):
        opened = open_clip(source)
        found = calibrate_clip(opened, frames=frames, prior=chosen.prior, settings=chosen.settings)
        estimate = demand(found.estimate, Demand(chosen.min_confidence, chosen.max_error))
        if estimate.found is None:
            return tell(source, estimate, ())
        first = opened.first(found.frames or range(len(opened.times)))

        def write(*, overwrite: bool) -> tuple[Path, ...]:
            told = (*first.notes, *_what_it_tells(opened, found), *_what_is_wrong(opened))
            named = first.but(path=opened.path, notes=told)
            curves = (("", estimate), *_own_curves(found))
            return tuple(
                file
                for part, own in curves
                for file in write_outputs(
                    named, own, chosen.settings, output, formats,
                    overwrite=overwrite, name=f"{opened.name}{part}",
                )
            )  # fmt: skip

        written = write(overwrite=chosen.overwrite or exr)
    notes = (*_what_is_wrong(opened), *_what_it_tells(opened, found))
    code = tell(source, estimate, written, notes=notes, verbose=chosen.verbose)
    if exr:
        known = len(opened.unread)
        how: dict[str, Any] = {"compression": compression, "overwrite": chosen.overwrite}
        count = _write_frames(opened, found, output, **how)
        if len(opened.unread) > known:
            write(overwrite=True)  # as records tell them
        if count < len(opened.times):
            return complain(f"{source}: {opened.left_out()}; without an EXR", UNREADABLE)
    return code


def _own_curves(found: ClipEstimate) -> Iterator[tuple[str, Estimate]]:
    """Parts that have a curve of their own, by what their files are named after the clip."""
    for number, shot in enumerate(found.shots, start=1):
        if shot.estimate is not None:
            yield f".shot{number}", shot.estimate
    for number, stretch in enumerate(found.stretches, start=1):
        yield f".stretch{number}", stretch.estimate


def _what_is_wrong(opened: Clip) -> tuple[str, ...]:
    return tuple(filter(None, (*opened.notes, opened.left_out())))


def _what_it_tells(opened: Clip, found: ClipEstimate) -> tuple[str, ...]:
    notes = []
    if found.frames:
        numbers = ", ".join(str(index + 1) for index in found.frames)
        notes.append(f"frames {numbers} of {len(opened.times)}")
        notes.append(f"the face's light varies by {found.exposure_stops:.1f} stops")
        notes.append(_drift(found.drift))
        if found.drift.is_sure:
            notes.append(_course(found))
        if found.exposures_told:
            notes.append("the files tell exposures that differ, which show the curve as a bracket")
        if found.noise_told:
            notes.append("the noise between frames that follow one another tells the exponent")
    for number, shot in enumerate(found.shots, start=1):
        if shot.estimate is not None:
            notes.append(
                f"shot {number} (from frame {shot.frames[0] + 1}) has a curve of its own, "
                f"{shot.misfit:.1f} standard deviations from the clip's"
            )
    return tuple(notes)


def _drift(drift: Drift) -> str:
    if drift.is_hidden:
        error = f"standard error {drift.error:.3f} stops: " if drift.error else ""
        why = "exposure goes one way over time, light moves, or frames or points are few"
        return f"whether the curve drifts cannot be told ({error}{why})"
    drifts = "drifts" if drift.is_sure else "is not seen to drift"
    return (
        f"the curve {drifts}: where the scene shows it, both ends lie {drift.stops:.3f} "
        f"stops apart (standard error {drift.error:.3f})"
    )


def _course(found: ClipEstimate) -> str:
    if found.maybe_feigned:
        return (
            "its exposure only rises or only falls, which can feign a drift: all frames have the "
            "one curve"
        )
    if not found.stretches:
        return "when its curve changes cannot be told: all frames have the one"
    each = ", ".join(
        f"stretch {number} (frames {one.frames[0] + 1} to {one.frames[-1] + 1})"
        for number, one in enumerate(found.stretches, start=1)
    )
    how = "goes evenly" if found.evenly else "jumps between frames that were looked at"
    return f"its curve {how}: {each} have curves of their own"


def _write_frames(opened: Clip, found: ClipEstimate, output: Path, **how: Any) -> int:
    from facecrf_ocio.clip.exr_sequence import write_sequence
    from facecrf_ocio.record.output_names import EXR, output_path

    folder, kept, count = output_path(output, opened.name, EXR), 0, 0
    cut: dict[str, int] = {}
    with status(f"writing {counted(len(opened.times), 'frame')}"):
        for exr, there in write_sequence(opened, found.of_frame, folder, **how):
            kept, count = kept + there, count + 1
            cut |= {note: cut.get(note, 0) + 1 for note in exr.notes}
    was = f", {kept} of them there already" if kept else ""
    say(f"  {folder}: {counted(count, 'frame')}{was}")
    for note, frames in cut.items():
        say(f"  note: in {counted(frames, 'frame')} {note}")
    return count
