"""The commands of nlcontrol, a file for each, or for those that belong together.

`nlcontrol.cli.command_line` names them in a table and loads the file of the one that is called. A command knows
`console` and the packages below it, and no other command.
"""
