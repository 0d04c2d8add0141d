"""Operators that wait for the command without stopping Blender: progress shown, Esc cancels."""

from __future__ import annotations

import time

import bpy

from .command import CommandError

_LOOK = 0.1  # seconds between two looks at whether the command has ended


class Working:
    """Base of operators whose `work` yields commands that it has started.

    Invoked by hand an operator is modal. Called from a script, or in a Blender without a window,
    it returns when all is done.
    """

    def begin(self, context):
        """Start the work; return what `execute` or `invoke` must."""
        self._work = self.work(context)
        self._said = ""
        if not self._advance(None):
            return self._result
        if not self._modal or bpy.app.background or context.window is None:
            return self._wait()
        self._timer = context.window_manager.event_timer_add(_LOOK, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.window_manager.progress_begin(0, 100)
        self._since = time.monotonic()
        return {"RUNNING_MODAL"}

    def execute(self, context):
        """Do all of it now; after a dialog, beside everything else."""
        self._modal = getattr(self, "_modal", False)
        return self.begin(context)

    def modal(self, context, event):
        """Look whether the command has ended; let everything else go on."""
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "cancelled; nothing was changed by the photo at work")
            return {"CANCELLED"}
        if event.type == "TIMER":
            self._show(context)
            if self._running.ended() and not self._advance(self._running.answer()):
                self._clear(context)
                return self._result
        return {"PASS_THROUGH"}

    def cancel(self, context):
        """End the command and forget the rest, as on Esc or when Blender is closed."""
        self._running.stop()
        self._work.close()
        self._clear(context)

    def say(self, text: str, done: float = 0.0) -> None:
        """Set what the status bar tells, and the share that is done."""
        self._said, self._done = text, done

    def _advance(self, answer) -> bool:
        """Go on to the next command; false at the end, with the result set."""
        try:
            self._running = self._work.send(answer)
        except StopIteration as end:
            self._result = end.value or {"FINISHED"}
            return False
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            self._result = {"CANCELLED"}
            return False
        return True

    def _wait(self):
        going = True
        while going:
            self._running.wait()
            going = self._advance(self._running.answer())
        return self._result

    def _show(self, context):
        seconds = time.monotonic() - self._since
        context.workspace.status_text_set(f"{self._said}   {seconds:.0f} s   Esc: cancel")
        # One photo has no parts to count, so that the number shows the seconds that pass.
        context.window_manager.progress_update(100 * self._done or seconds % 100)

    def _clear(self, context):
        context.workspace.status_text_set(None)
        context.window_manager.progress_end()
        context.window_manager.event_timer_remove(self._timer)
