"""The commands of nlcontrol, a file for each, or for those that belong together.

A table in `nlcontrol.cli.command_line` names them; the file of the one that is called is loaded. A
command knows `console` and the packages below it, and no other command.
"""
