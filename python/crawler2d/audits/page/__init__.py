"""One HTML page that shows an audit, with replays of where the robot seized."""

from crawler2d.audits.page.report import audit_page

__all__ = ["audit_page"]
