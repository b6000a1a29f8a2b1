"""A worker process that answers without Blender: what it is asked for, as the text of an error."""

import sys

from thenar_blender import names

TASK = {"case": {}, "thenar": names.VERSION}
"""A task of this version."""
HELLO = f"""print('{{"thenar": "{names.VERSION}", "ready": true}}', flush=True)"""


def command(value, hello=HELLO):
    """The command of a worker that says hello, then answers each line with the text of the expression `value`."""
    answer = f"print(json.dumps({{'error': str({value})}}), flush=True)"
    return [sys.executable, "-c", f"import json, os, sys\n{hello}\nfor line in sys.stdin: {answer}"]
