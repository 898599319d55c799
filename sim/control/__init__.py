"""Control of arm and hand: laws, guards, sensing, and the execution of plans."""
