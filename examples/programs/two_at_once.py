"""Two sessions at a server at once, awaited."""

import asyncio
import sys

from nlcontrol import AsyncClient, Result


async def push(client: AsyncClient, seed: int) -> Result:
    """The result of a push on a table of its own."""
    async with await client.sessions.open("kitchen", seed=seed) as session:
        offer = await session.plan("push the mug 3 cm to the left")
        return await session.execute(offer)


async def main() -> None:
    """Two pushes side by side."""
    async with AsyncClient(sys.argv[1]) as client:
        for result in await asyncio.gather(push(client, 1), push(client, 2)):
            print(result)


asyncio.run(main())
