"""What the user sets once: where the command is, and how it estimates."""

# Names, signatures and lists as Blender asks for them.
# ruff: noqa: D101, D102, ARG002

from __future__ import annotations

import bpy

from .command import CommandError, find_command

# As `facecrf explain estimators` tells them.
ESTIMATORS = (
    ("auto", "Recommended", "Every cue of the photo; a photo without a face is refused"),
    ("joint", "Every cue", "Every cue of the photo; without a face, what cameras do on average"),
    ("face", "Face (the paper)", "Skin's pigments, shading removed with the face's geometry"),
    ("face-unshaded", "Face, shading ignored", "The paper's variant without geometry"),
    ("edge", "Edges", "Colors blend along lines; needs no face"),
    ("geometry-invariant", "Planes of light", "Needs no face but smooth ramps"),
    ("intensity-similarity", "Noise", "Needs no face but noise that nothing removed"),
    ("rank", "Blends", "Low rank of blended colors; needs no face"),
    ("mean", "Mean response", "What cameras do on average, without looking at the photo"),
    ("srgb", "sRGB", "The standard's curve, without looking at the photo"),
    ("gamma22", "Gamma 2.2", "A power of 2.2, without looking at the photo"),
    ("identity", "None", "The code values as they are"),
)


class FacecrfPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    command: bpy.props.StringProperty(
        name="facecrf command",
        description="The command, or the folder of the environment it is installed in",
        default="facecrf",
        subtype="FILE_PATH",
    )
    estimator: bpy.props.EnumProperty(name="Estimator", items=ESTIMATORS, default="auto")

    def draw(self, context):
        self.layout.prop(self, "command")
        self.layout.prop(self, "estimator")
        try:
            self.layout.label(text=find_command(self.path), icon="CHECKMARK")
        except CommandError as error:
            self.layout.label(text=str(error), icon="ERROR")

    @property
    def path(self) -> str:
        """The command as set, `//` being the folder of the .blend file."""
        return bpy.path.abspath(self.command)


def preferences(context):
    """Return the preferences of this extension."""
    return context.preferences.addons[__package__].preferences
