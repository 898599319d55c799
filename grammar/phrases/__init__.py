"""The lark tree to phrase parts; the grammar file `nlcontrol.lark` lies here."""
