"""What a robot is told of its cell: mount, home, table, sensor data sheets."""
