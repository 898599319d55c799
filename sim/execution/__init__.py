"""A plan carried out: push, grasp and lid execution."""
