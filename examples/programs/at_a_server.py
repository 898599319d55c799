"""The same at a server: sessions, runs, and what the host knows."""

import sys

from nlcontrol import Client

with Client(sys.argv[1]) as client:
    print(client.health(), [scene.name for scene in client.scenes()])
    with client.sessions.open("kitchen", seed=1) as session:
        print(session.say("push the mug 3 cm to the left"))
        print(session.say("undo that"))
    print([run.text for run in client.runs.list(session=session.session_id).runs])
