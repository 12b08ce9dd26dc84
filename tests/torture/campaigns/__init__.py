"""All campaigns, in the order of the table."""

from torture.campaign import Campaign
from torture.campaigns import calls, files, models, planted, records

CAMPAIGNS: dict[str, Campaign] = {
    module.CAMPAIGN.name: module.CAMPAIGN for module in (planted, models, records, files, calls)
}
