"""A robot as model files hold it: links, joints and shapes in three dimensions."""
