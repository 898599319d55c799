"""Description of a robot's cell: mount, home, table, sensor data sheets."""
