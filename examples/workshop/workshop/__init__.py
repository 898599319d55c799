"""What is said in a workshop."""

WORDS = {
    # "(a|b)" is a choice, "[c]" may be left out.
    "verbs": [{"says": ["shimmy", "jiggle [over]"], "action": "slide", "goal": "displace"}],
    "terminals": {
        "DIRECTION": {"left": ["to port"], "right": ["to starboard"]},
        "MANNER": {"gentle": ["with kid gloves"]},
    },
    "adjectives": {"grey": ["silver"]},
    "names": ["hard drive"],  # "hard" would be read as how to push
}
