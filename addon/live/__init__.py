"""Live: contact follows while hand, armature or product move. Registration only."""

from . import watch

register = watch.register
unregister = watch.unregister
